#pragma once

#include "core/association/acceptance.hpp"
#include "core/association/paper_search.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/fix.hpp"
#include "core/mapping/landmark_map.hpp"
#include "core/memory/arena.hpp"

#include <span>

namespace slamsensor::core {

/// Finds scans in one frozen map: every query stands alone, and none changes the map. One thread; no
/// allocation after construction.
class Localizer {
 public:
  Localizer(Arena& arena, const Config& config) noexcept;

  /// Makes `map_W` (m) the map. False, and the map is empty, when it exceeds capacities.map_landmarks or
  /// holds a point that is not finite or out of reach.
  [[nodiscard]] bool set_map(std::span<const Point2> map_W) noexcept;

  /// The fix of a scan (m, L; at most capacities.scan_landmarks, the rest is not looked at). `pose_W`,
  /// `matches` and the covariance are those of the best candidate, whatever the status.
  [[nodiscard]] Fix locate(std::span<const Point2> scan_L, const Deadline& deadline) noexcept;

 private:
  Config config_;
  LandmarkMap map_;
  Delaunay delaunay_;
  PaperSearch search_;
  Candidates found_;
};

}  // namespace slamsensor::core
