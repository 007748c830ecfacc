#pragma once

#include <Eigen/Core>

#include <cmath>
#include <numbers>

namespace slamsensor::core {

/// A point of the plane, m. Its frame is named where it is used: W map, L sensor (x' forward, y' left).
using Point2 = Eigen::Vector2d;

/// `angle_rad` brought into [-pi, pi).
[[nodiscard]] inline double wrap_angle(double angle_rad) noexcept {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double wrapped = angle_rad - kTurn * std::floor((angle_rad + std::numbers::pi) / kTurn);
  return wrapped >= std::numbers::pi ? -std::numbers::pi : wrapped;
}

/// A rigid motion of the plane. As `T_W_L` it takes coordinates in L to W: p_W = T_W_L * p_L. Heading is
/// counter-clockwise from W's x axis.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;

  [[nodiscard]] Point2 translation() const noexcept { return {x_m, y_m}; }

  [[nodiscard]] Point2 operator*(const Point2& p) const noexcept {
    const double c = std::cos(heading_rad);
    const double s = std::sin(heading_rad);
    return {x_m + c * p.x() - s * p.y(), y_m + s * p.x() + c * p.y()};
  }

  /// T_A_C = T_A_B * T_B_C.
  [[nodiscard]] Pose2 operator*(const Pose2& other) const noexcept {
    const Point2 t = *this * other.translation();
    return {t.x(), t.y(), wrap_angle(heading_rad + other.heading_rad)};
  }

  [[nodiscard]] Pose2 inverse() const noexcept {
    const double c = std::cos(heading_rad);
    const double s = std::sin(heading_rad);
    return {-c * x_m - s * y_m, s * x_m - c * y_m, wrap_angle(-heading_rad)};
  }
};

/// A pose whose sine and cosine are taken once, to move many points.
class RigidMotion {
 public:
  explicit RigidMotion(const Pose2& pose) noexcept
      : t_(pose.translation()), c_(std::cos(pose.heading_rad)), s_(std::sin(pose.heading_rad)) {}

  /// The motion that takes `from` to `to` and turns by the angle whose cosine and sine are to each other as
  /// `dot` to `turned`; no turn when both are zero.
  [[nodiscard]] static RigidMotion from_direction(const Point2& from, const Point2& to, double dot,
                                                  double turned) noexcept {
    RigidMotion move{Pose2{}};
    const double length = std::sqrt(dot * dot + turned * turned);
    if (length > 0.0) {
      move.c_ = dot / length;
      move.s_ = turned / length;
    }
    move.t_ = Point2(to.x() - move.c_ * from.x() + move.s_ * from.y(),
                     to.y() - move.s_ * from.x() - move.c_ * from.y());
    return move;
  }

  [[nodiscard]] double cosine() const noexcept { return c_; }
  [[nodiscard]] double sine() const noexcept { return s_; }
  [[nodiscard]] Pose2 pose() const noexcept { return {t_.x(), t_.y(), std::atan2(s_, c_)}; }

  [[nodiscard]] Point2 operator()(const Point2& p) const noexcept {
    return {t_.x() + c_ * p.x() - s_ * p.y(), t_.y() + s_ * p.x() + c_ * p.y()};
  }

 private:
  Point2 t_;
  double c_;
  double s_;
};

}  // namespace slamsensor::core
