#include "firmware/store/map_snapshot.hpp"

#include <algorithm>
#include <span>

namespace slamsensor::firmware {

MapSnapshot::MapSnapshot(const core::Capacities& capacities)
    : landmarks_(capacities.map_landmarks),
      positions_W_(capacities.map_landmarks, core::Point2::Zero()),
      path_(capacities.path_poses) {
}

bool MapSnapshot::take(const core::HypothesisSet& hypotheses) noexcept {
  const core::MapState state = hypotheses.state();
  revision_ = hypotheses.revision();
  const bool fits = state.landmarks.size() <= landmarks_.size() && state.path.size() <= path_.size();
  landmark_count_ = fits ? state.landmarks.size() : 0;
  pose_count_ = fits ? state.path.size() : 0;
  std::copy_n(state.landmarks.begin(), landmark_count_, landmarks_.begin());
  std::copy_n(state.positions_W.begin(), landmark_count_, positions_W_.begin());
  std::copy_n(state.path.begin(), pose_count_, path_.begin());
  numbers_ = fits ? state : core::MapState{};
  numbers_.landmarks = {};
  numbers_.positions_W = {};
  numbers_.path = {};
  return fits;
}

core::MapState MapSnapshot::state() const noexcept {
  core::MapState state = numbers_;
  state.landmarks = std::span(landmarks_).first(landmark_count_);
  state.positions_W = std::span(positions_W_).first(landmark_count_);
  state.path = std::span(path_).first(pose_count_);
  return state;
}

}  // namespace slamsensor::firmware
