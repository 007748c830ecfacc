#include "core/detection/landmark_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace slamsensor::core {

LandmarkDetector::LandmarkDetector(Arena& arena, const DetectionConfig& config,
                                   const Capacities& capacities) noexcept
    : point_(config.point),
      range_max_m_(config.range_max_m),
      scanline_(arena, config),
      web_(arena, config, capacities.occupied_cells),
      hull_(arena, web_.grid()),
      heaviest_(arena, "detected groups", config.detected_most()),
      landmarks_(arena.take<ScanLandmark>("detected landmarks", config.detected_most())),
      farthest_(arena, "view: farthest cells", web_.grid().columns()),
      free_m_(arena, "view: free ranges", web_.grid().columns()) {
  SLAMSENSOR_ASSERT(free_m_.try_resize(free_m_.capacity()) && farthest_.try_resize(farthest_.capacity()));
}

void LandmarkDetector::add_scanline(std::span<const Reading> scanline) noexcept {
  for (const Sighting& sighting : scanline_.sightings(scanline)) {
    web_.add(sighting);
  }
  if (!scanline_.left_out()) {
    readings_ += scanline.size();
    look_far();
  }
}

void LandmarkDetector::look_far() noexcept {
  const std::span<const std::int32_t> row = scanline_.row();
  for (std::size_t column = 0; column < row.size(); ++column) {
    std::array<std::int32_t, kFarthest>& cells = farthest_[column].cells;
    std::int32_t cell = row[column];
    looks_ += cell != kEmptyColumn ? 1 : 0;
    for (std::size_t i = 0; i < kFarthest && cell != kEmptyColumn; ++i) {
      if (cell > cells[i]) {
        std::swap(cell, cells[i]);
      }
    }
  }
}

ScanView LandmarkDetector::view() const noexcept {
  ScanView view;
  view.free_m = free_m_.span();
  view.range_m = range_max_m_;
  view.shows_faces = true;
  return view;
}

std::span<const ScanLandmark> LandmarkDetector::finish() noexcept {
  web_.take_heaviest(heaviest_);
  for (std::size_t i = 0; i < heaviest_.size(); ++i) {
    landmarks_[i].position_L = point_L(heaviest_[i]);
    landmarks_[i].weight = heaviest_[i].weight();
    landmarks_[i].diameter_m = diameter_m(heaviest_[i], landmarks_[i].position_L.norm());
  }
  for (std::size_t column = 0; column < farthest_.size(); ++column) {
    const auto& cells = farthest_[column].cells;
    const auto least =
        std::find_if(cells.rbegin(), cells.rend(), [](std::int32_t cell) { return cell != kEmptyColumn; });
    free_m_[column] = least == cells.rend() ? ScanView::kUnknown
                      : *least == kInfiniteColumn
                          ? static_cast<float>(range_max_m_)
                          : static_cast<float>(web_.grid().radius_m(static_cast<std::uint32_t>(*least)));
    farthest_[column] = Farthest{};
  }
  readings_ = looks_ = 0;
  return {landmarks_, heaviest_.size()};
}

/// Of a round thing whose near face is `range_m` away on the average, a quarter of pi of its radius before
/// its centre. One column is as wide as anything thinner: no measurement. Where a column has many readings,
/// the two at the ends are one more than the thing is wide.
double LandmarkDetector::diameter_m(const CellGroup& group, double range_m) const noexcept {
  constexpr double kColumnsMin = 1.5;
  constexpr double kMeanFace = 0.25 * std::numbers::pi;
  const double readings =
      static_cast<double>(readings_) / static_cast<double>(std::max<std::uint64_t>(1, looks_));
  const double wide = group.columns_wide() - 1.0 + 1.0 / std::max(1.0, readings);
  const double half_rad = 0.5 * wide * 2.0 * std::numbers::pi / static_cast<double>(web_.grid().columns());
  if (wide < kColumnsMin || half_rad > 0.25 * std::numbers::pi) {
    return 0.0;
  }
  return 2.0 * range_m * std::sin(half_rad) / (1.0 - kMeanFace * std::sin(half_rad));
}

Point2 LandmarkDetector::point_L(const CellGroup& group) noexcept {
  if (point_ == LandmarkPoint::ReadingMean) {
    return Point2(group.sum_x_m, group.sum_y_m) / static_cast<double>(group.count);
  }
  return hull_.centroid_L(web_.cells(group));
}

}  // namespace slamsensor::core
