#pragma once

#include "core/mapping/map_state.hpp"
#include "core/slam.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace slamsensor::firmware {

/// A copy of the home map as it stood at one moment, to be handed from the SLAM thread to those that
/// save, send or draw it (MapOutlet). Its memory is taken and written to at construction.
class MapSnapshot {
 public:
  MapSnapshot() = default;
  explicit MapSnapshot(const core::Capacities& capacities);

  /// What such a copy takes from the heap.
  [[nodiscard]] static std::size_t bytes(const core::Capacities& capacities) noexcept {
    return capacities.map_landmarks * (sizeof(core::MapLandmark) + sizeof(core::Point2)) +
           capacities.path_poses * sizeof(core::PathPose);
  }

  /// Holds what `slam` now holds as its home map; empty when there is none. No allocation.
  void take(const core::Slam& slam) noexcept;

  /// Views of this object; without landmarks when it is empty.
  [[nodiscard]] core::MapState state() const noexcept;

  [[nodiscard]] bool empty() const noexcept { return landmark_count_ == 0; }
  /// Slam::revision() at that moment.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }

 private:
  std::vector<core::MapLandmark> landmarks_;  // as long as the capacities are, always
  std::vector<core::Point2> positions_W_;
  std::vector<core::PathPose> path_;
  std::size_t landmark_count_ = 0;
  std::size_t pose_count_ = 0;
  core::MapState numbers_;  // its spans are empty
  std::uint64_t revision_ = 0;
};

}  // namespace slamsensor::firmware
