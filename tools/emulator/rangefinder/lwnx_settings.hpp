#pragma once

#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/rangefinder/lwnx_packet.hpp"
#include "tools/emulator/rangefinder/lwnx_product.hpp"
#include "tools/emulator/rangefinder/outbox.hpp"
#include "tools/emulator/rangefinder/sight.hpp"

#include <cstdint>
#include <string>

namespace slamsensor::tools {

/// What the lost-signal counter counts; the manuals leave it open.
enum class LwnxLostCount : std::uint8_t {
  Repeats,  ///< misses that repeat the last distance; the next one is reported as lost
  Misses,   ///< the miss that is reported as lost: 1 (and 0) repeats nothing
};

/// What a write is answered with: the value that is kept now, if it can be read, or nothing.
enum class LwnxWriteAnswer : std::uint8_t { Value, Empty };

/// What is streamed before the first LWNX packet.
enum class LwnxLegacyStream : std::uint8_t { None, Sf30Binary };

/// How an EmulatedLwnx is built and set up. What the manuals do not tell is a setting.
struct LwnxSettings {
  LwnxProduct product = lwnx_product(LwnxModel::Lw20);
  DeviceBegin begin = DeviceBegin::PowerUp;
  std::uint32_t baud = 0;  ///< 0: the product's
  double full_speed_hz = 20'000.0;
  std::uint8_t raw_readings = 200;  ///< in a packet of ID 40, at most 255
  OutboxDelays delays;
  double crystal_ppm = 0.0;
  Stamp boot_time = std::chrono::milliseconds(300);
  Stamp restart_delay = std::chrono::milliseconds(20);  ///< from the reset command to the restart
  std::uint32_t transmit_buffer_bytes = 512;
  std::uint64_t seed = 1;

  LwnxLostCount lost_count = LwnxLostCount::Misses;
  LwnxWriteAnswer write_answer = LwnxWriteAnswer::Value;
  LwnxAccess write_answer_flag = LwnxAccess::Write;  ///< access bit of answers to writes
  std::uint16_t first_token = 0x1234;
  std::string serial_number = "EMU-000001";

  StrengthModel strength{1.5e5, 100.0};  ///< per cent
  double weak_strength = 1.0;            ///< per cent, while the fault WeakSignal lasts
  double saturated_strength = 120.0;     ///< per cent, while the fault Saturation lasts

  Stamp screen_period{};           ///< of a line of text while no packet has come yet; 0: none
  double text_no_return_m = -1.0;  ///< distance in ASCII answers when nothing came back
  LwnxLegacyStream legacy = LwnxLegacyStream::None;
  std::uint16_t legacy_no_return_cm = 16'000;
};

/// Sets the update rate that the device has from the beginning: the nearest the product knows, or the full
/// speed of its raw stream from half of that on (LW20: high-speed mode).
void set_rate(LwnxSettings& settings, double rate_hz);

}  // namespace slamsensor::tools
