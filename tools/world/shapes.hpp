#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// What a ray can meet.
enum class Surface : std::uint8_t { None, Ground, Stem, Crown, Bush, Rock, Post, Person, Car, Wall };

/// "tree", "bush", "rock", "post", ... as written to stems.csv.
[[nodiscard]] constexpr std::string_view name_of(Surface surface) noexcept {
  constexpr std::string_view kNames[] = {"none", "ground", "tree",   "crown", "bush",
                                         "rock", "post",   "person", "car",   "wall"};
  return kNames[static_cast<std::size_t>(surface)];
}

/// A thing that stands at one place for good: Stem (with its crown), Bush, Rock or Post. Frame W.
struct Object {
  Surface kind = Surface::Stem;
  double x_m = 0.0;
  double y_m = 0.0;
  double ground_m = 0.0;  ///< height of the ground at (x, y)
  double radius_m = 0.0;  ///< of the footprint: the stem, not the crown
  double height_m = 0.0;  ///< above the ground
  double crown_radius_m = 0.0;
  double crown_base_m = 0.0;  ///< above the ground
};

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

enum class ShapeForm : std::uint8_t { Cylinder, Spheroid, Wall };

/// One convex body that stands still. Frame W.
struct Shape {
  ShapeForm form = ShapeForm::Cylinder;
  Surface surface = Surface::None;
  std::uint32_t object = 0;  ///< index of the object, or of the wall, that it belongs to
  double x_m = 0.0;          ///< axis; a wall's first end
  double y_m = 0.0;
  double z_low_m = 0.0;
  double z_high_m = 0.0;
  double radius_m = 0.0;
  double along_x_m = 0.0;  ///< from a wall's first end to its second
  double along_y_m = 0.0;
  double stops_per_m = 0.0;  ///< above zero for a porous body, which a ray may pass
};

/// Where a ray ends.
struct Hit {
  double distance_m = kMiss;
  Surface surface = Surface::None;
  std::uint32_t index = 0;  ///< of the object, wall or mover, by `surface`
};

/// Shapes in a uniform horizontal grid that rays are traced through cell by cell (Amanatides and Woo, "A Fast
/// Voxel Traversal Algorithm", 1987). Immutable.
class ShapeGrid {
 public:
  explicit ShapeGrid(std::span<const Shape> shapes);

  /// The first shape that `ray` meets nearer than `limit_m`, or a Hit without a surface. A porous shape is
  /// passed or not by a number made of `ray_key` and the shape alone, so that equal arguments give equal
  /// results.
  [[nodiscard]] Hit first_hit(const Ray& ray, double limit_m, std::uint64_t ray_key) const noexcept;

 private:
  struct Box2 {
    double x_low, x_high, y_low, y_high;
  };
  struct CellRange {
    std::size_t column_first, column_last, row_first, row_last;
  };

  [[nodiscard]] static Box2 bounds_of(const Shape& shape) noexcept;
  [[nodiscard]] std::size_t column(double x_m) const noexcept;
  [[nodiscard]] std::size_t row(double y_m) const noexcept;
  [[nodiscard]] CellRange cells_of(const Shape& shape) const noexcept;
  void measure(std::span<const Shape> shapes);
  void fill(std::span<const Shape> shapes);
  void test_cell(std::size_t cell, const Ray& ray, std::uint64_t ray_key, Hit& nearest) const noexcept;

  Box2 bounds_{0.0, 0.0, 0.0, 0.0};
  double z_low_m_ = 0.0;
  double z_high_m_ = 0.0;
  double cell_m_ = 1.0;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<std::uint32_t> cell_begin_;  // columns * rows + 1 offsets into shapes_
  std::vector<Shape> shapes_;              // by cell; a shape is in every cell that it touches
};

}  // namespace slamsensor::tools
