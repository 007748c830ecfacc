#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <numbers>

namespace slamsensor::tools {

PtuSettings exact_settings(PtuKind kind) {
  PtuSettings settings = ptu_settings(kind);
  settings.begin = PtuBegin::Ready;
  settings.limit_spread = 0;
  settings.reply_latency = {3ms, 0ms};
  settings.table_times = {10ms, 10ms, 10ms, 10ms};
  return settings;
}

void PtuBench::type(std::string_view text) {
  const std::vector<std::uint8_t> raw(text.begin(), text.end());
  port.host_write(raw, now);
}

void PtuBench::run_to(Stamp until) {
  while (now < until) {
    now = std::min(until, std::max(port.next_event(), now + 1us));
    port.advance(now);
  }
  std::array<WireByte, 256> taken{};
  while (const std::size_t count = port.host_take(taken, now)) {
    bytes.insert(bytes.end(), taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

std::string PtuBench::heard() {
  std::string text;
  for (const WireByte& byte : bytes) {
    text += static_cast<char>(byte.value);
  }
  bytes.clear();
  return text;
}

std::string PtuBench::ask(std::string_view text, Stamp span) {
  bytes.clear();
  type(text);
  run_for(span);
  return heard();
}

void PtuBench::fault(FaultKind kind, Stamp duration) {
  EXPECT_TRUE(ptu.inject({kind, now, duration})) << name_of(kind);
}

double PtuBench::pan_steps(Stamp at) const {
  return ptu.angles_at(at).pan_rad * 180.0 * 3600.0 / std::numbers::pi / 185.1428;
}

double PtuBench::tilt_steps(Stamp at) const {
  return ptu.angles_at(at).tilt_rad * 180.0 * 3600.0 / std::numbers::pi / 185.1428;
}

std::string ptu_text(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '\r' || c == '\n') {
      text += c == '\r' ? "\\r" : "\\n";
    } else if (code >= 0x20 && code < 0x7F) {
      text += c;
    } else {
      std::array<char, 8> hex{};
      std::snprintf(hex.data(), hex.size(), "\\x%02X", code);
      text += hex.data();
    }
  }
  return text;
}

}  // namespace slamsensor::tools
