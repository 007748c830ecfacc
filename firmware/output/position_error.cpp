#include "firmware/output/position_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::firmware {

PositionError position_error(const Eigen::Matrix2d& covariance_m2) noexcept {
  const double east = covariance_m2(0, 0);
  const double north = covariance_m2(1, 1);
  const double cross = 0.5 * (covariance_m2(0, 1) + covariance_m2(1, 0));
  const double mean = 0.5 * (east + north);
  const double radius = std::hypot(0.5 * (east - north), cross);  // of Mohr's circle
  // The major axis lies at angle a from north towards east with tan 2a = 2 cross / (north - east).
  double bearing_deg = 0.5 * std::atan2(2.0 * cross, north - east) * 180.0 / std::numbers::pi;
  bearing_deg += bearing_deg < 0.0 ? 180.0 : 0.0;
  PositionError error;
  error.east_m = std::sqrt(std::max(east, 0.0));
  error.north_m = std::sqrt(std::max(north, 0.0));
  error.major_m = std::sqrt(std::max(mean + radius, 0.0));
  error.minor_m = std::sqrt(std::max(mean - radius, 0.0));
  error.major_bearing_deg = bearing_deg >= 180.0 ? 0.0 : bearing_deg;
  return error;
}

bool usable_covariance(const Eigen::Matrix3d& covariance) noexcept {
  return covariance.allFinite() && covariance.diagonal().minCoeff() >= 0.0;
}

}  // namespace slamsensor::firmware
