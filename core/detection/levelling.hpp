#pragma once

#include "core/reading.hpp"

#include <Eigen/Core>

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

/// R_V_L, which takes directions in L to V.
[[nodiscard]] Eigen::Matrix3d level_from_sensor(const Attitude& attitude) noexcept;

/// The unit vector in L that points up when the sensor leans by `attitude`.
[[nodiscard]] Eigen::Vector3d up_L(const Attitude& attitude) noexcept;

/// The attitude at which `up` points up: the inverse of up_L(), in (-180, 180] and [-90, 90] deg. `up` need
/// not have unit length, but must not be zero.
[[nodiscard]] Attitude attitude_of_up(const Eigen::Vector3d& up) noexcept;

/// The angle between z' and the vertical, [0, pi].
[[nodiscard]] double lean_rad(const Attitude& attitude) noexcept;

/// The angle between the two verticals as L sees them, [0, pi]: by how much the sensor was tilted, headings
/// aside.
[[nodiscard]] double angle_between_rad(const Attitude& a, const Attitude& b) noexcept;

/// The attitude of the sensor L from that of an inclinometer I which is fixed to it. `offset` is what I tells
/// while L stands upright.
[[nodiscard]] Attitude without_offset(const Attitude& told_I, const Attitude& offset) noexcept;

/// Turns readings of a leaning sensor into the level frame V.
class Levelling {
 public:
  /// `attitude` is the sensor's during all the readings that are turned.
  explicit Levelling(const Attitude& attitude) noexcept;

  /// The same shot seen from V: pan in [-pi, pi], tilt above the horizontal. Range or no return stay as they
  /// are. A reading with an angle that is not finite gets angles that are not finite.
  [[nodiscard]] Reading operator()(const Reading& reading_L) const noexcept;

 private:
  Eigen::Matrix3d R_V_L_;
};

}  // namespace slamsensor::core
