#pragma once

#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// A uniform grid over a set of points: look-ups by place. Cells are as small as the memory of 4 per point
/// allows, but not below the side asked for. One thread.
class PointGrid {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  PointGrid(Arena& arena, const char* name, std::uint32_t points_max) noexcept;

  /// Indexes `points` (W, m; finite), which must stay alive and unchanged while the grid is used.
  void build(std::span<const Point2> points, double cell_side_min_m) noexcept;

  /// Makes this grid equal to `other` (same capacity), over `points`, which must equal the other's.
  void copy_from(const PointGrid& other, std::span<const Point2> points) noexcept;

  /// Index of the point nearest to `p` within `radius_m` (the lower index of two at the same distance), or
  /// kNone.
  [[nodiscard]] std::uint32_t nearest_within(const Point2& p, double radius_m) const noexcept;

  /// Number of points within `radius_m` of `p`.
  [[nodiscard]] std::uint32_t count_within(const Point2& p, double radius_m) const noexcept;

 private:
  struct CellRange {
    std::int64_t x_begin, x_end, y_begin, y_end;  // half open, clipped to the grid
  };
  [[nodiscard]] CellRange cells_around(const Point2& p, double radius_m) const noexcept;
  template <typename Visit>
  void visit_within(const Point2& p, double radius_m, Visit&& visit) const noexcept;

  BoundedVector<std::uint32_t> first_;    // first entry of each cell, one more at the end
  BoundedVector<std::uint32_t> entries_;  // point indices, by cell
  std::span<const Point2> points_;
  Point2 origin_ = Point2::Zero();
  double cells_per_m_ = 1.0;
  std::int64_t columns_ = 0;
  std::int64_t rows_ = 0;
};

}  // namespace slamsensor::core
