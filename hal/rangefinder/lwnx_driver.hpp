#pragma once

#include "hal/init_error.hpp"
#include "hal/rangefinder/range_driver.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>

namespace slamsensor::hal {

enum class LwnxMode : std::uint8_t {
  Readings,     ///< a packet for each reading
  ReadingsMm,   ///< the same in millimetres, where the product can
  RawReadings,  ///< 20 000 readings a second in packets of 200, where the product can; no strength
};

enum class BaudPolicy : std::uint8_t {
  Keep,    ///< the device stays at the line rate at which it is found
  Change,  ///< the configured rate is stored in the device, which is restarted for it
};

struct LwnxConfig {
  /// saturated_from infinite: as the product's table says.
  RangeConfig range = {.clock = {.tolerance_ppm = 10000.0}};  // LightWare's rates are rounded
  std::uint32_t baud = 115200;  ///< tried first; the others of kLwnxBauds follow
  BaudPolicy baud_policy = BaudPolicy::Keep;
  LwnxMode mode = LwnxMode::Readings;
  double rate_hz = 388.0;                ///< the nearest that the product has is set; unused by RawReadings
  std::int32_t lost_signal_counter = 1;  ///< misses until "lost" is said; before that old values repeat
  Stamp reply_patience = std::chrono::milliseconds(200);
};

/// A driver for LightWare's rangefinders that speak LWNX (LW20 serial manual and its relatives'), which finds
/// the line rate and the product by itself. `link` outlives it. An error names the setting, its value and
/// what is allowed.
[[nodiscard]] tl::expected<std::unique_ptr<Rangefinder>, InitError> make_lwnx_rangefinder(
    const LwnxConfig& config, ByteLink& link);

}  // namespace slamsensor::hal
