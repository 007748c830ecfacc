#include "firmware/store/map_text.hpp"

#include "firmware/store/map_layout.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

namespace slamsensor::firmware {
namespace {

constexpr std::int64_t kUtcEnd = 253'402'300'800;  // 10000-01-01
constexpr std::size_t kPrintableMax = 32;

struct Utc {
  int year, month, day, hour, minute, second;
};

Utc utc_of(std::int64_t seconds) {
  using namespace std::chrono;  // NOLINT(google-build-using-namespace): the calendar
  const sys_seconds time{std::chrono::seconds(std::clamp<std::int64_t>(seconds, 0, kUtcEnd - 1))};
  const sys_days day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss<std::chrono::seconds> clock(time - day);
  return {int(date.year()),
          static_cast<int>(unsigned(date.month())),
          static_cast<int>(unsigned(date.day())),
          static_cast<int>(clock.hours().count()),
          static_cast<int>(clock.minutes().count()),
          static_cast<int>(clock.seconds().count())};
}

std::string formatted(const char* format, std::int64_t seconds) {
  const Utc t = utc_of(seconds);
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, t.year, t.month, t.day, t.hour, t.minute, t.second);
  return text.data();
}

bool is_name_character(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

}  // namespace

bool is_map_name(std::string_view name) {
  return !name.empty() && name.size() <= kMapNameMax &&
         std::all_of(name.begin(), name.end(), is_name_character);
}

bool is_utc(std::int64_t seconds) {
  return seconds >= 0 && seconds < kUtcEnd;
}

std::string utc_text(std::int64_t seconds) {
  return formatted("%04d-%02d-%02dT%02d:%02d:%02dZ", seconds);
}

std::string utc_name(std::int64_t seconds) {
  return formatted("%04d%02d%02dT%02d%02d%02dZ", seconds);
}

std::string printable_bytes(std::span<const std::uint8_t> bytes) {
  std::string text = "\"";
  for (const std::uint8_t byte : bytes.first(std::min(bytes.size(), kPrintableMax))) {
    if (byte >= ' ' && byte <= '~') {
      text += static_cast<char>(byte);
    } else {
      std::array<char, 8> escaped{};
      std::snprintf(escaped.data(), escaped.size(), "\\x%02X", byte);
      text += escaped.data();
    }
  }
  return text + (bytes.size() > kPrintableMax ? "\"..." : "\"");
}

std::string printable_bytes(std::string_view text) {
  return printable_bytes(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

}  // namespace slamsensor::firmware
