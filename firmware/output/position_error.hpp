#pragma once

#include <Eigen/Core>

namespace slamsensor::firmware {

/// The 1 sigma error of a position, m, on true east and north, and its ellipse.
struct PositionError {
  double east_m = 0.0;
  double north_m = 0.0;
  double major_m = 0.0;
  double minor_m = 0.0;
  double major_bearing_deg = 0.0;  ///< clockwise from the second axis (north), [0, 180)
};

/// The ellipse of a covariance (m^2) of (east, north), or of any two axes.
[[nodiscard]] PositionError position_error(const Eigen::Matrix2d& covariance_m2) noexcept;

/// True when `covariance` of (x, y, heading) is finite and has no negative variance.
[[nodiscard]] bool usable_covariance(const Eigen::Matrix3d& covariance) noexcept;

}  // namespace slamsensor::firmware
