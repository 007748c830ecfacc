#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamsensor::tools {

inline constexpr double kMiss = std::numeric_limits<double>::infinity();

/// A half line in W; `direction_W` has length 1.
struct Ray {
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_W = Eigen::Vector3d::UnitX();
};

/// The part of a ray inside a convex body, m from its origin, never behind it; empty when `in_m > out_m`.
struct Chord {
  double in_m = kMiss;
  double out_m = -kMiss;

  [[nodiscard]] bool empty() const noexcept { return !(in_m <= out_m); }
};

[[nodiscard]] inline Chord intersect(const Chord& a, const Chord& b) noexcept {
  return {std::max(a.in_m, b.in_m), std::min(a.out_m, b.out_m)};
}

/// Where origin + t * direction is within [low, high] along one axis, t >= 0.
[[nodiscard]] inline Chord slab_chord(double origin, double direction, double low, double high) noexcept {
  if (direction == 0.0) {
    return origin >= low && origin <= high ? Chord{0.0, kMiss} : Chord{};
  }
  const double t_low = (low - origin) / direction;
  const double t_high = (high - origin) / direction;
  return {std::max(0.0, std::min(t_low, t_high)), std::max(t_low, t_high)};
}

/// Where a t^2 + 2 b t + c <= 0 and t >= 0; a >= 0.
[[nodiscard]] inline Chord quadratic_chord(double a, double b, double c) noexcept {
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0 || (c > 0.0 && b >= 0.0)) {
    return {};
  }
  if (a == 0.0) {
    return c <= 0.0 ? Chord{0.0, kMiss} : Chord{};
  }
  const double root = std::sqrt(discriminant);
  return {std::max(0.0, (-b - root) / a), (-b + root) / a};
}

/// Vertical cylinder around (x, y), with flat ends at z_low and z_high.
[[nodiscard]] inline Chord cylinder_chord(const Ray& ray, double x_m, double y_m, double radius_m,
                                          double z_low_m, double z_high_m) noexcept {
  const double ox = ray.origin_W.x() - x_m;
  const double oy = ray.origin_W.y() - y_m;
  const double dx = ray.direction_W.x();
  const double dy = ray.direction_W.y();
  const Chord disc =
      quadratic_chord(dx * dx + dy * dy, ox * dx + oy * dy, ox * ox + oy * oy - radius_m * radius_m);
  if (disc.empty()) {
    return {};
  }
  return intersect(disc, slab_chord(ray.origin_W.z(), ray.direction_W.z(), z_low_m, z_high_m));
}

/// Spheroid with a vertical axis of symmetry from z_low to z_high above (x, y).
[[nodiscard]] inline Chord spheroid_chord(const Ray& ray, double x_m, double y_m, double radius_m,
                                          double z_low_m, double z_high_m) noexcept {
  const double squash =
      2.0 * radius_m / (z_high_m - z_low_m);  // scales z so that the spheroid becomes a sphere
  const double ox = ray.origin_W.x() - x_m;
  const double oy = ray.origin_W.y() - y_m;
  const double oz = (ray.origin_W.z() - 0.5 * (z_low_m + z_high_m)) * squash;
  const double dx = ray.direction_W.x();
  const double dy = ray.direction_W.y();
  const double dz = ray.direction_W.z() * squash;
  return quadratic_chord(dx * dx + dy * dy + dz * dz, ox * dx + oy * dy + oz * dz,
                         ox * ox + oy * oy + oz * oz - radius_m * radius_m);
}

/// A box that stands upright around `centre_W`; `forward` is the horizontal unit vector along its length.
struct Box {
  Eigen::Vector3d centre_W;
  Eigen::Vector2d forward_W;
  Eigen::Vector3d half_size_m;  ///< along, across, up
};

[[nodiscard]] Chord box_chord(const Ray& ray, const Box& box) noexcept;

/// Distance along `ray` to the vertical rectangle between z_low and z_high over the segment from `from` by
/// `along` (m), kMiss when it is not met. Both sides stop a ray.
[[nodiscard]] double wall_distance_m(const Ray& ray, const Eigen::Vector2d& from_W,
                                     const Eigen::Vector2d& along_m, double z_low_m,
                                     double z_high_m) noexcept;

}  // namespace slamsensor::tools
