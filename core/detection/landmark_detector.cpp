#include "core/detection/landmark_detector.hpp"

namespace slamsensor::core {

LandmarkDetector::LandmarkDetector(Arena& arena, const DetectionConfig& config,
                                   const Capacities& capacities) noexcept
    : point_(config.point),
      scanline_(arena, config),
      web_(arena, config, capacities.occupied_cells),
      hull_(arena, web_.grid()),
      heaviest_(arena, "detected groups", config.landmarks_max),
      landmarks_(arena.take<ScanLandmark>("detected landmarks", config.landmarks_max)) {
}

void LandmarkDetector::add_scanline(std::span<const Reading> scanline) noexcept {
  for (const Sighting& sighting : scanline_.sightings(scanline)) {
    web_.add(sighting);
  }
}

std::span<const ScanLandmark> LandmarkDetector::finish() noexcept {
  web_.take_heaviest(heaviest_);
  for (std::size_t i = 0; i < heaviest_.size(); ++i) {
    landmarks_[i].position_L = point_L(heaviest_[i]);
    landmarks_[i].weight = heaviest_[i].weight();
  }
  return {landmarks_, heaviest_.size()};
}

Point2 LandmarkDetector::point_L(const CellGroup& group) noexcept {
  if (point_ == LandmarkPoint::ReadingMean) {
    return Point2(group.sum_x_m, group.sum_y_m) / static_cast<double>(group.count);
  }
  return hull_.centroid_L(web_.cells(group));
}

}  // namespace slamsensor::core
