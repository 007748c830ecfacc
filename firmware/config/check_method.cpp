#include "firmware/config/rules.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace slamsensor::firmware {
namespace {

constexpr double kGridCellsMax = 2e7;  // the paper's grid has 420,600 cells

double grid_columns(const core::DetectionConfig& detection) {
  return std::ceil(2.0 * std::numbers::pi / detection.bearing_step_rad);
}

double grid_cells(const core::DetectionConfig& detection) {
  return std::ceil(detection.range_max_m / detection.range_step_m) * grid_columns(detection);
}

/// Edges that a map of `landmarks` needs at `depth`: a triangular lattice has 3 depth (depth + 1) / 2 for a
/// landmark, and 1000 random points have 9784 at depth 2 (DESIGN 2.3), a tenth more than the lattice.
double edges_needed(double landmarks, double depth) {
  return std::ceil(
      std::min(1.1 * 1.5 * depth * (depth + 1.0) * landmarks, 0.5 * landmarks * (landmarks - 1.0)));
}

}  // namespace

void check_method(Rules& rules) {
  const core::DetectionConfig& detection = rules.config().core.detection;
  const core::AssociationConfig& association = rules.config().core.association;
  const core::Capacities& capacities = rules.config().core.capacities;
  const double cells = grid_cells(detection);
  const double edges = edges_needed(capacities.map_landmarks, association.depth);
  rules.require(detection.tilt_min_rad <= detection.tilt_max_rad,
                {"detection.tilt_min_deg", "detection.tilt_max_deg"}, "is above");
  rules.require(detection.range_min_m < detection.range_max_m,
                {"detection.range_min_m", "detection.range_max_m"}, "is not below");
  rules.require(detection.range_step_m <= detection.range_max_m,
                {"detection.range_step_m", "detection.range_max_m"}, "is above");
  rules.require(cells <= kGridCellsMax,
                {"detection.range_step_m", "detection.bearing_step_deg", "detection.range_max_m"},
                "makes a grid of " + real_text(cells) + " cells, more than the allowed " +
                    real_text(kGridCellsMax) + ", with");
  rules.require(association.landmarks_min <= detection.landmarks_max,
                {"association.landmarks_min", "detection.landmarks_max"},
                "leaves no scan to be searched: it is above");
  rules.require(capacities.occupied_cells >= grid_columns(detection),
                {"capacities.occupied_cells", "detection.bearing_step_deg"},
                "is too small for the cells of one scanline all the way round,");
  rules.require(capacities.scan_landmarks >= detection.landmarks_max,
                {"capacities.scan_landmarks", "detection.landmarks_max"}, "is too small for");
  rules.require(capacities.map_landmarks >= detection.landmarks_max,
                {"capacities.map_landmarks", "detection.landmarks_max"},
                "is too small for the landmarks of one scan,");
  rules.require(capacities.map_edges >= edges,
                {"capacities.map_edges", "capacities.map_landmarks", "association.depth"},
                "is too small: " + std::to_string(static_cast<long long>(edges)) + " edges are needed with");
}

}  // namespace slamsensor::firmware
