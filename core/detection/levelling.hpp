#pragma once

#include "core/reading.hpp"

#include <Eigen/Core>

namespace slamsensor::core {

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
