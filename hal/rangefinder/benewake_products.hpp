#pragma once

#include "hal/rangefinder/range_driver.hpp"

#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::hal {

enum class BenewakeModel : std::uint8_t { Tf03, TfMini, TfMiniPlus, TfMiniS, Tf02 };

enum class BenewakeCommands : std::uint8_t {
  None,       ///< the device sends and does not listen (or listens to another protocol)
  Rate,       ///< version, format, rate, baud, output
  OverRange,  ///< those and the over-range value
};

/// What a distance word means when it is no distance.
struct RangeCode {
  std::uint16_t word = 0;
  Echo echo = Echo::None;
};

/// What differs between the devices that send Benewake's 9-byte frame (manuals of TF03, TFmini, TFmini Plus,
/// TFmini-S, TF02).
struct BenewakeProduct {
  std::string_view name;
  BenewakeCommands commands = BenewakeCommands::Rate;
  double rate_max_hz = 1000.0;
  double weak_below = 0.0;  ///< strength
  std::span<const RangeCode> codes{};
  bool has_reliability = false;  ///< byte 6 tells 7 or 8 for a distance to be trusted
};

[[nodiscard]] const BenewakeProduct& benewake_product(BenewakeModel model) noexcept;

/// The fields of a reading, on whichever line it came.
struct BenewakeReading {
  std::uint16_t distance_cm = 0;
  std::uint16_t strength = 0;
  std::uint8_t reliability = 0;
};

/// A reading as a measurement: codes and `over_range_cm` (0: none) told apart from distances, then judged().
[[nodiscard]] Measurement measured(const BenewakeReading& reading, const BenewakeProduct& product,
                                   std::uint16_t over_range_cm) noexcept;

}  // namespace slamsensor::hal
