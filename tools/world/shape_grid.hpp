#pragma once

#include "tools/world/objects.hpp"
#include "tools/world/shapes.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::tools {

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
