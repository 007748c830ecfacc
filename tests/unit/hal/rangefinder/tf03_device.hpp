#pragma once

#include "tests/unit/hal/rangefinder/hex.hpp"

#include <cstdint>
#include <string>

namespace slamsensor::tests {

inline const std::string kVersion = hex_text("5A 04 01 5F");
inline const std::string kRate1000 = hex_text("5A 06 03 E8 03 4E");
inline const std::string kReading = hex_text("59 59 D2 04 B0 04 00 00 3C");
inline const std::string kOverRange = hex_text("59 59 50 46 0C 00 00 00 54");

/// A TF03 as its manual describes it: sends at 100 Hz after power-up, echoes its settings.
struct Tf03 {
  int period_ms = 10;
  bool is_dead = false;
  bool sends = true;
  std::string reading = kReading;

  std::string answer(const std::string& request) {
    if (is_dead) {
      return "";
    }
    if (request == kVersion) {
      return hex_text("5A 07 01 02 02 01 67");
    }
    if (request.size() == 6 && request[2] == 3) {
      const int rate = static_cast<std::uint8_t>(request[3]) | static_cast<std::uint8_t>(request[4]) << 8;
      period_ms = rate >= 1000 ? 1 : 1000 / rate;
      return request;
    }
    if (request.size() == 6 && request[2] == 0x4F) {
      return hex_text("5A 05 4F 00 AE");
    }
    sends = sends || request == hex_text("5A 05 07 01 67");
    return request;
  }
  std::string tick(int tick) const { return sends && !is_dead && tick % period_ms == 0 ? reading : ""; }
  void power_cycle() {
    period_ms = 10;
    sends = true;
  }
};

}  // namespace slamsensor::tests
