#include "core/association/point_grid.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

constexpr std::uint32_t kCellsPerPoint = 4;

struct Box {
  Point2 low = Point2::Zero();
  Point2 high = Point2::Zero();
};

Box bounding_box(std::span<const Point2> points) noexcept {
  Box box;
  if (!points.empty()) {
    box.low = box.high = points.front();
  }
  for (const Point2& p : points) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

}  // namespace

PointGrid::PointGrid(Arena& arena, const char* name, std::uint32_t points_max) noexcept
    : first_(arena, name, static_cast<std::size_t>(points_max) * kCellsPerPoint + 2),
      entries_(arena, name, points_max) {
}

void PointGrid::build(std::span<const Point2> points, double cell_side_min_m) noexcept {
  points_ = points;
  const Box box = bounding_box(points);
  origin_ = box.low;
  const Point2 extent = box.high - box.low;
  // A side s gives (w/s + 1)(h/s + 1) cells; the larger of these two solves that for the cells there is
  // memory for.
  const double cells = std::max(1.0, static_cast<double>(points.size()) * (kCellsPerPoint - 1));
  double side_m = std::max({cell_side_min_m, std::sqrt(extent.x() * extent.y() / cells) * 1.2,
                            (extent.x() + extent.y()) / cells * 2.0});
  cells_per_m_ = 1.0 / side_m;
  columns_ = static_cast<std::int64_t>(extent.x() * cells_per_m_) + 1;
  rows_ = static_cast<std::int64_t>(extent.y() * cells_per_m_) + 1;
  while (columns_ * rows_ + 1 > static_cast<std::int64_t>(first_.capacity())) {
    side_m *= 2.0;
    cells_per_m_ = 1.0 / side_m;
    columns_ = static_cast<std::int64_t>(extent.x() * cells_per_m_) + 1;
    rows_ = static_cast<std::int64_t>(extent.y() * cells_per_m_) + 1;
  }
  const std::size_t cell_count = static_cast<std::size_t>(columns_ * rows_);
  const auto cell_of = [&](const Point2& p) {
    const auto x = static_cast<std::int64_t>((p.x() - origin_.x()) * cells_per_m_);
    const auto y = static_cast<std::int64_t>((p.y() - origin_.y()) * cells_per_m_);
    return static_cast<std::size_t>(std::min(y, rows_ - 1) * columns_ + std::min(x, columns_ - 1));
  };
  first_.clear();
  SLAMSENSOR_ASSERT(first_.try_resize(cell_count + 1, 0));
  SLAMSENSOR_ASSERT(entries_.try_resize(points.size()));
  for (const Point2& p : points) {
    ++first_[cell_of(p)];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& count : first_) {
    sum += count;
    count = sum;
  }
  for (std::size_t i = points.size(); i-- > 0;) {  // backwards: entries of a cell end up by increasing index
    entries_[--first_[cell_of(points[i])]] = static_cast<std::uint32_t>(i);
  }
}

void PointGrid::copy_from(const PointGrid& other, std::span<const Point2> points) noexcept {
  SLAMSENSOR_ASSERT(first_.assign(other.first_.span()) && entries_.assign(other.entries_.span()));
  points_ = points;
  origin_ = other.origin_;
  cells_per_m_ = other.cells_per_m_;
  columns_ = other.columns_;
  rows_ = other.rows_;
}

PointGrid::CellRange PointGrid::cells_around(const Point2& p, double radius_m) const noexcept {
  // Compared before it is converted: no cell number overflows, and what is no number gives no cell.
  const auto first_cell = [](double cell, std::int64_t count) {
    return cell < static_cast<double>(count) ? (cell > 0.0 ? static_cast<std::int64_t>(cell) : 0) : count;
  };
  const auto end_cell = [](double cell, std::int64_t count) {
    return cell >= 0.0 ? (cell < static_cast<double>(count) ? static_cast<std::int64_t>(cell) + 1 : count)
                       : 0;
  };
  const double x = (p.x() - origin_.x()) * cells_per_m_;
  const double y = (p.y() - origin_.y()) * cells_per_m_;
  const double r = radius_m * cells_per_m_;
  return {first_cell(x - r, columns_), end_cell(x + r, columns_), first_cell(y - r, rows_),
          end_cell(y + r, rows_)};
}

template <typename Visit>
void PointGrid::visit_within(const Point2& p, double radius_m, Visit&& visit) const noexcept {
  if (points_.empty()) {
    return;
  }
  const CellRange cells = cells_around(p, radius_m);
  const double radius2 = radius_m * radius_m;
  const std::uint32_t* const first = first_.begin();
  const std::uint32_t* const entries = entries_.begin();
  for (std::int64_t y = cells.y_begin; y < cells.y_end; ++y) {
    // Cells of a row are neighbours in memory, and so are their entries.
    if (cells.x_begin >= cells.x_end) {
      return;
    }
    const std::uint32_t end = first[y * columns_ + cells.x_end];
    for (std::uint32_t e = first[y * columns_ + cells.x_begin]; e < end; ++e) {
      const double distance2 = (points_[entries[e]] - p).squaredNorm();
      if (distance2 <= radius2) {
        visit(entries[e], distance2);
      }
    }
  }
}

std::uint32_t PointGrid::nearest_within(const Point2& p, double radius_m) const noexcept {
  std::uint32_t best = kNone;
  double best2 = 0.0;
  visit_within(p, radius_m, [&](std::uint32_t index, double distance2) {
    if (best == kNone || distance2 < best2 || (distance2 == best2 && index < best)) {
      best = index;
      best2 = distance2;
    }
  });
  return best;
}

std::uint32_t PointGrid::count_within(const Point2& p, double radius_m) const noexcept {
  std::uint32_t count = 0;
  visit_within(p, radius_m, [&](std::uint32_t, double) { ++count; });
  return count;
}

}  // namespace slamsensor::core
