#include "firmware/store/map_snapshot.hpp"

#include <span>

namespace slamsensor::firmware {

MapSnapshot::MapSnapshot(const core::Capacities& capacities)
    : landmarks_(capacities.map_landmarks),
      positions_W_(capacities.map_landmarks, core::Point2::Zero()),
      path_(capacities.path_poses) {
}

void MapSnapshot::take(const core::Slam& slam) noexcept {
  const core::MapState state = slam.copy_map({landmarks_, positions_W_, path_});
  revision_ = slam.revision();
  landmark_count_ = state.landmarks.size();
  pose_count_ = state.path.size();
  numbers_ = state;
  numbers_.landmarks = {};
  numbers_.positions_W = {};
  numbers_.path = {};
}

core::MapState MapSnapshot::state() const noexcept {
  core::MapState state = numbers_;
  state.landmarks = std::span(landmarks_).first(landmark_count_);
  state.positions_W = std::span(positions_W_).first(landmark_count_);
  state.path = std::span(path_).first(pose_count_);
  return state;
}

}  // namespace slamsensor::firmware
