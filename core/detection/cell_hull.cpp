#include "core/detection/cell_hull.hpp"

#include "core/geometry/convex_hull.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {

// Of all corners on a ray from the origin only the first and the last can be vertices of the hull, so a group
// of any size has at most two candidates per column.
CellHull::CellHull(Arena& arena, const PolarGrid& grid) noexcept
    : grid_(grid),
      rays_(arena.take<Ray>("cell hull rays", grid.columns())),
      corners_(arena.take<Point2>("cell hull corners", 2 * std::size_t{grid.columns()})),
      hull_(arena.take<Point2>("cell hull vertices", 4 * std::size_t{grid.columns()})) {
}

Point2 CellHull::centroid_L(std::span<const std::uint32_t> cells) noexcept {
  for (const std::uint32_t cell : cells) {
    const std::uint32_t column = cell % grid_.columns();
    extend(column, cell / grid_.columns());
    extend(grid_.next(column), cell / grid_.columns());
  }
  corner_count_ = 0;
  for (const std::uint32_t cell : cells) {
    const std::uint32_t column = cell % grid_.columns();
    take_corners(column);
    take_corners(grid_.next(column));
  }
  const std::size_t vertices =
      convex_hull({corners_, corner_count_}, {hull_, 4 * std::size_t{grid_.columns()}});
  return area_centroid({hull_, vertices});
}

/// Adds to the ray the two corners that a cell in `row` has on it.
void CellHull::extend(std::uint32_t ray, std::uint32_t row) noexcept {
  Ray& corners = rays_[ray];
  corners.inner_row = corners.outer_row == 0 ? row : std::min(corners.inner_row, row);
  corners.outer_row = std::max(corners.outer_row, row + 1);
}

/// Moves the ray's corners to the list; nothing when it has none.
void CellHull::take_corners(std::uint32_t ray) noexcept {
  const Ray corners = rays_[ray];
  if (corners.outer_row == 0) {
    return;
  }
  rays_[ray] = Ray{};
  const double edge_rad = grid_.edge_rad(ray);
  const Point2 direction(std::cos(edge_rad), std::sin(edge_rad));
  corners_[corner_count_++] = grid_.radius_m(corners.inner_row) * direction;
  corners_[corner_count_++] = grid_.radius_m(corners.outer_row) * direction;
}

}  // namespace slamsensor::core
