#pragma once

#include "core/detection/polar_grid.hpp"
#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// The convex hull of a group of polar cells (the paper's section II-A). No allocation after construction;
/// one thread.
class CellHull {
 public:
  CellHull(Arena& arena, const PolarGrid& grid) noexcept;

  /// Centroid (sensor frame, m) of the convex hull of the corners of `cells` (row * columns + column, not
  /// empty): four each, or three in row 0, where two fall together in the origin. A single cell has an area
  /// already. Cells so wide that their corners lie on one line (two columns) give the middle of that line.
  [[nodiscard]] Point2 centroid_L(std::span<const std::uint32_t> cells) noexcept;

 private:
  /// Innermost and outermost corner on the ray that bounds a column from below; none while outer is 0.
  struct Ray {
    std::uint32_t inner_row = 0;
    std::uint32_t outer_row = 0;
  };

  void extend(std::uint32_t ray, std::uint32_t row) noexcept;
  void take_corners(std::uint32_t ray) noexcept;

  PolarGrid grid_;
  Ray* rays_;  // per column; all without corners between calls
  Point2* corners_;
  Point2* hull_;
  std::uint32_t corner_count_ = 0;
};

}  // namespace slamsensor::core
