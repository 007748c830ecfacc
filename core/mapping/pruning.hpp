#pragma once

#include "core/config.hpp"
#include "core/mapping/landmark_map.hpp"
#include "core/mapping/positional_error.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Negative information (DESIGN 2.6): a landmark that scans which should have seen it did not see is
/// forgotten. A scan should have seen what lies inside the convex hull of the sensor and of the landmarks
/// that it did see.
class Pruning {
 public:
  Pruning(Arena& arena, const MappingConfig& config, const Capacities& capacities) noexcept;

  /// Counts the scan as a chance for every landmark it should have seen or did match, and takes out of the
  /// map those whose share of sightings among at least `prune_chances_min` chances is below `prune_share`.
  /// Does nothing when `prune_share` is 0 (the paper). Call it after the matched landmarks are updated and
  /// before new ones are added.
  void apply(const ScanInMap& scan, LandmarkMap& map) noexcept;

 private:
  MappingConfig config_;
  BoundedVector<Point2> corners_W_;
  BoundedVector<bool> drop_;
};

}  // namespace slamsensor::core
