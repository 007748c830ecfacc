#pragma once

#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/fix.hpp"
#include "core/mapping/atlas.hpp"
#include "core/memory/arena.hpp"

#include <span>

namespace slamsensor::core {

/// Finds scans in one frozen map: every query stands alone, and none changes the map. In a survey the answers
/// so far teach how far landmarks scatter about it (Rates), which later queries are judged by. One thread; no
/// allocation after construction.
class Localizer {
 public:
  Localizer(Arena& arena, const Config& config) noexcept : atlas_(arena, config) {}

  /// Makes `map_W` (m), a survey that leaves nothing out, the map, with a size of each or no sizes. False,
  /// and the map is empty, when it exceeds capacities.map_landmarks or holds a point that is not finite or
  /// out of reach.
  [[nodiscard]] bool set_map(std::span<const Point2> map_W,
                             std::span<const LandmarkSize> sizes = {}) noexcept;

  /// Makes `state` the map, as Slam::restore does: a survey only where it says that it is one. With a flaw
  /// the map is as it was.
  [[nodiscard]] MapCheck restore(const MapState& state) noexcept;

  /// The fix of a scan (heaviest landmarks first). `pose_W`, `matches` and the covariance are those of the
  /// best candidate, whatever the status.
  [[nodiscard]] Fix locate(std::span<const ScanLandmark> landmarks, const ScanView& view,
                           const Deadline& deadline) noexcept {
    return atlas_.process(landmarks, view, deadline);
  }

 private:
  Atlas atlas_;
};

}  // namespace slamsensor::core
