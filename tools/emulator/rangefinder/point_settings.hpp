#pragma once

#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/rangefinder/outbox.hpp"
#include "tools/emulator/rangefinder/point_format.hpp"

#include <cstdint>
#include <string>

namespace slamsensor::tools {

/// Which commands a point laser takes.
enum class PointDialect : std::uint8_t {
  None,    ///< it streams from power-up on and hears nothing
  Lds70a,  ///< ASTECH LDS70A, LAM71, LDM71
  Ldm41e,  ///< ASTECH LDM41E: the same grammar, fewer commands, SD d, h or s
};

/// What ends continuous measuring. The manuals leave it open.
enum class PointStop : std::uint8_t { Escape, Command, Either };

/// How an EmulatedPointLaser is built and set up.
struct PointSettings {
  PointDialect dialect = PointDialect::None;
  PointFormat format;
  DeviceBegin begin = DeviceBegin::PowerUp;
  std::uint32_t baud = 115200;
  std::uint32_t factory_baud = 115200;  ///< after the fault BaudReset
  double rate_hz = 1000.0;              ///< LDS70A: MF / SA, limited by the line rate
  std::string autostart = "DT";         ///< a command done at power-up; unused without commands
  std::string identity = "LDS70A 1.02 EMU-000001";
  PointStop stop = PointStop::Either;
  OutboxDelays delays;
  double crystal_ppm = 0.0;
  Stamp boot_time = std::chrono::milliseconds(300);
  std::uint32_t transmit_buffer_bytes = 64;
  std::uint64_t seed = 1;

  StrengthModel quality{4e5, 1500.0};
  double quality_of_weak = 5.0;        ///< while the fault WeakSignal lasts and the record tells quality
  double quality_of_blinded = 2000.0;  ///< while the fault Saturation lasts, likewise
};

/// ASTECH LDS70A (user manual, pages 34 to 56). The layout of its records is chosen to have the widths of
/// table 7: 11, 16, 17 or 22 bytes of text, 2, 3, 3 or 4 binary.
[[nodiscard]] PointSettings lds70a_settings();

/// ASTECH LDM41E (manual, pages 27, 28 and 35).
[[nodiscard]] PointSettings ldm41e_settings();

/// MDL LaserAce IM HR. Unverified: nothing is public but 1 kHz, 300 m and a resolution of 0.1 m; the record,
/// a decimal number and CR LF, is a guess.
[[nodiscard]] PointSettings laserace_im_settings();

}  // namespace slamsensor::tools
