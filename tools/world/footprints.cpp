#include "tools/world/footprints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamsensor::tools {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kCellMin_m = 4.0;
constexpr double kCellsPerSide = 512.0;

double cell_size_m(const AreaConfig& area) noexcept {
  return std::max({kCellMin_m, (area.x_max_m - area.x_min_m) / kCellsPerSide,
                   (area.y_max_m - area.y_min_m) / kCellsPerSide});
}

std::size_t cell_count(double length_m, double cell_m) noexcept {
  return static_cast<std::size_t>(std::floor(length_m / cell_m)) + 1;
}

// What lies outside the area is kept in the cells along its edge.
std::size_t clamped_cell(double offset_m, double cell_m, std::size_t count) noexcept {
  const double cell = std::clamp(std::floor(offset_m / cell_m), 0.0, static_cast<double>(count - 1));
  return static_cast<std::size_t>(cell);
}

}  // namespace

Footprints::Footprints(const AreaConfig& area)
    : area_(area),
      cell_m_(cell_size_m(area)),
      columns_(cell_count(area.x_max_m - area.x_min_m, cell_m_)),
      rows_(cell_count(area.y_max_m - area.y_min_m, cell_m_)),
      first_(columns_ * rows_, kNone) {
}

std::size_t Footprints::column(double x_m) const noexcept {
  return clamped_cell(x_m - area_.x_min_m, cell_m_, columns_);
}

std::size_t Footprints::row(double y_m) const noexcept {
  return clamped_cell(y_m - area_.y_min_m, cell_m_, rows_);
}

void Footprints::add_circle(const core::Point2& centre_W, double radius_m) {
  std::uint32_t& first = first_[row(centre_W.y()) * columns_ + column(centre_W.x())];
  circles_.push_back({centre_W, radius_m, first});
  first = static_cast<std::uint32_t>(circles_.size() - 1);
  radius_max_m_ = std::max(radius_max_m_, radius_m);
}

void Footprints::add_wall(const WallConfig& wall) {
  walls_.push_back(wall);
}

bool Footprints::is_clear(const core::Point2& centre_W, double reach_m) const noexcept {
  for (const WallConfig& wall : walls_) {
    if (distance_to_wall_m(centre_W, wall) < reach_m) {
      return false;
    }
  }
  const double search_m = reach_m + radius_max_m_;
  const std::size_t column_end = column(centre_W.x() + search_m);
  const std::size_t row_end = row(centre_W.y() + search_m);
  for (std::size_t r = row(centre_W.y() - search_m); r <= row_end; ++r) {
    for (std::size_t c = column(centre_W.x() - search_m); c <= column_end; ++c) {
      for (std::uint32_t i = first_[r * columns_ + c]; i != kNone; i = circles_[i].next) {
        const double gap_m = reach_m + circles_[i].radius_m;
        if ((circles_[i].centre_W - centre_W).squaredNorm() < gap_m * gap_m) {
          return false;
        }
      }
    }
  }
  return true;
}

double distance_to_wall_m(const core::Point2& p_W, const WallConfig& wall) noexcept {
  const core::Point2 from(wall.x1_m, wall.y1_m);
  const core::Point2 along = core::Point2(wall.x2_m, wall.y2_m) - from;
  const double length_2 = along.squaredNorm();
  const double share = length_2 > 0.0 ? std::clamp((p_W - from).dot(along) / length_2, 0.0, 1.0) : 0.0;
  return (p_W - from - share * along).norm();
}

}  // namespace slamsensor::tools
