#pragma once

#include <cstdint>

namespace slamsensor::core {

/// One shot of the rangefinder in the sensor frame (x' forward, y' left, z' up).
struct Reading {
  double pan_rad = 0.0;   ///< theta', counter-clockwise from x'
  double tilt_rad = 0.0;  ///< phi', up positive
  double range_m = 0.0;   ///< d; kNoReturn when nothing came back

  static constexpr double kNoReturn = -1.0;

  [[nodiscard]] bool has_return() const noexcept { return range_m >= 0.0; }
};

}  // namespace slamsensor::core
