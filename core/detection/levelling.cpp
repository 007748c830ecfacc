#include "core/detection/levelling.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace slamsensor::core {

Eigen::Matrix3d level_from_sensor(const Attitude& attitude) noexcept {
  return (Eigen::AngleAxisd(attitude.pitch_rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(attitude.roll_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d up_L(const Attitude& attitude) noexcept {
  return level_from_sensor(attitude).row(2).transpose();
}

Attitude attitude_of_up(const Eigen::Vector3d& up) noexcept {
  return {std::atan2(up.y(), up.z()), std::atan2(-up.x(), std::hypot(up.y(), up.z()))};
}

double lean_rad(const Attitude& attitude) noexcept {
  return angle_between_rad(attitude, {});
}

double angle_between_rad(const Attitude& a, const Attitude& b) noexcept {
  const Eigen::Vector3d up_a = up_L(a);
  const Eigen::Vector3d up_b = up_L(b);
  return std::atan2(up_a.cross(up_b).norm(), up_a.dot(up_b));
}

Attitude without_offset(const Attitude& told_I, const Attitude& offset) noexcept {
  // With L upright the level frame is L, so that R_L_I is what takes I to the level then.
  return attitude_of_up(level_from_sensor(offset) * up_L(told_I));
}

Levelling::Levelling(const Attitude& attitude) noexcept : R_V_L_(level_from_sensor(attitude)) {
}

Reading Levelling::operator()(const Reading& reading_L) const noexcept {
  const double cos_tilt = std::cos(reading_L.tilt_rad);
  const Eigen::Vector3d direction_L(cos_tilt * std::cos(reading_L.pan_rad),
                                    cos_tilt * std::sin(reading_L.pan_rad), std::sin(reading_L.tilt_rad));
  const Eigen::Vector3d direction_V = R_V_L_ * direction_L;
  return {std::atan2(direction_V.y(), direction_V.x()),
          std::atan2(direction_V.z(), direction_V.head<2>().norm()), reading_L.range_m};
}

}  // namespace slamsensor::core
