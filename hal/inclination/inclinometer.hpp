#pragma once

#include "hal/device.hpp"
#include "hal/fixed_text.hpp"
#include "hal/stamp.hpp"

#include <cmath>
#include <optional>

namespace slamsensor::hal {

/// How an inclinometer leans. Its axes: x forward, y left, z up (REP 103). Both angles are right-handed, roll
/// about x (positive: left side up), pitch about y (positive: front down), in the order that
/// core/reading.hpp defines.
struct Inclination {
  Stamp stamp{};  ///< middle of the measurement
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
};

/// The inclination at which the unit vector (x, y, z) of the inclinometer points up.
[[nodiscard]] inline Inclination inclination_of_up(Stamp stamp, double x, double y, double z) noexcept {
  return {stamp, std::atan2(y, z), std::atan2(-x, std::hypot(y, z))};
}

/// A device that measures how it leans while it rests.
class Inclinometer : public Device {
 public:
  /// What was measured since the last call, the newest; nothing when nothing was.
  [[nodiscard]] virtual std::optional<Inclination> take() noexcept = 0;

  /// What the device says of itself; empty before it did.
  [[nodiscard]] virtual FixedText<80> model() const noexcept = 0;
};

}  // namespace slamsensor::hal
