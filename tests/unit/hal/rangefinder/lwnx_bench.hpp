#pragma once

#include "hal/rangefinder/lwnx_driver.hpp"
#include "hal/rangefinder/lwnx_packet.hpp"
#include "tests/unit/hal/rangefinder/hex.hpp"
#include "tests/unit/hal/rangefinder/range_bench.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::tests {

using hal::LwnxAccess;
using hal::LwnxConfig;
using hal::make_lwnx_rangefinder;
using hal::write_lwnx;

inline std::string packet(std::uint8_t id, std::string_view data) {
  std::vector<std::uint8_t> out(data.size() + 6);
  (void)write_lwnx(id, LwnxAccess::Read, bytes_of(data), out);
  return tests::text_of(out);
}

inline std::string word16(int value) {
  return {static_cast<char>(value & 0xFF), static_cast<char>((value >> 8) & 0xFF)};
}
inline std::string word32(std::int32_t value) {
  return word16(value & 0xFFFF) + word16((value >> 16) & 0xFFFF);
}

/// A LightWare that answers writes with their echo and streams readings.
struct LightWare {
  std::string name = "LW20";
  int silent_requests = 2;  // after power-up
  std::map<int, std::string> settings;
  std::function<std::string(int)> reading = [](int) { return packet(44, word16(1234) + word16(57)); };
  double rate_hz = 388.0;  // on average; sent in whole milliseconds
  bool streams = false;
  bool is_dead = false;
  bool lies = false;

  std::string answer(const std::string& request) {
    if (is_dead || (silent_requests > 0 && silent_requests-- > 0)) {
      return "";
    }
    if (request.size() < 6 || static_cast<std::uint8_t>(request[0]) != 0xAA) {
      return "";
    }
    const int id = static_cast<std::uint8_t>(request[3]);
    const bool is_write = (request[1] & 1) != 0;
    std::string data = request.substr(4, request.size() - 6);
    if (!is_write) {
      if (id == 10) {
        return packet(10, hex_text("34 12"));
      }
      data = id == 0 ? name + std::string(16 - name.size(), '\0') : "";
    } else {
      settings[id] = data;
      streams = id == 30 ? data[0] != 0 : streams;
      if (lies && id != 30) {
        data[0] = static_cast<char>(data[0] ^ 1);
      }
    }
    return packet(static_cast<std::uint8_t>(id), data);
  }
};

inline void connect(RangeBench& bench, LightWare& device, const LwnxConfig& config) {
  auto driver = make_lwnx_rangefinder(config, bench.link);
  ASSERT_TRUE(driver) << driver.error().message;
  bench.driver = std::move(*driver);
  bench.on_request = [&](const std::string& request) { return device.answer(request); };
  bench.on_tick = [&](int tick) {
    const auto sent_by = [&](int ms) { return static_cast<int>(ms * device.rate_hz / 1000.0); };
    const bool is_due = sent_by(tick) != sent_by(tick - 1);
    return device.streams && !device.is_dead && is_due ? device.reading(tick) : "";
  };
}

inline LwnxConfig config_at(double rate_hz) {
  LwnxConfig config;
  config.rate_hz = rate_hz;
  config.range.clock.tolerance_ppm = 50000.0;  // the bench sends in whole milliseconds
  return config;
}

}  // namespace slamsensor::tests
