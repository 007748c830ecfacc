#pragma once

#include "core/geometry/pose2.hpp"

#include <cstdint>

namespace slamsensor::core {

/// How the sensor leans (the paper's section II-A: it stands upright, or its roll and pitch are known).
///
/// Axes of L: x' forward, y' left, z' up (ISO 8855, REP 103); both angles are right-handed. Roll turns about
/// x': positive lifts the left side. Pitch turns about y': positive lowers the front. The level frame V has
/// its z axis along the vertical and its x axis below or above x': R_V_L = R_y(pitch) R_x(roll). No heading
/// is in it, so that the heading of a levelled scan is that of x' seen from above.
struct Attitude {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
};

/// One shot of the rangefinder in the sensor frame (x' forward, y' left, z' up).
struct Reading {
  double pan_rad = 0.0;   ///< theta', counter-clockwise from x'
  double tilt_rad = 0.0;  ///< phi', up positive
  double range_m = 0.0;   ///< d; kNoReturn when nothing came back

  static constexpr double kNoReturn = -1.0;

  [[nodiscard]] bool has_return() const noexcept { return range_m >= 0.0; }
};

/// A landmark as one scan sees it.
struct ScanLandmark {
  Point2 position_L = Point2::Zero();  ///< in the sensor frame, m
  double weight = 0.0;                 ///< the detector's certainty: larger is better; only the order matters
  double diameter_m = 0.0;             ///< 0: not measured
};

}  // namespace slamsensor::core
