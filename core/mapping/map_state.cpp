#include "core/mapping/map_state.hpp"

#include "core/graph/lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace slamsensor::core {
namespace {

constexpr std::size_t kLandmarksMin = 3;
constexpr std::uint32_t kNoParent = MapLandmark::kNoParent;

MapCheck check_counts(const MapState& state, const Capacities& capacities) noexcept {
  const std::size_t count = state.landmarks.size();
  if (count < kLandmarksMin) {
    return {MapFlaw::TooFewLandmarks, count};
  }
  if (count > capacities.map_landmarks) {
    return {MapFlaw::TooManyLandmarks, count};
  }
  if (state.path.size() > capacities.path_poses) {
    return {MapFlaw::TooManyPoses, state.path.size()};
  }
  if (state.positions_W.size() != count) {
    return {MapFlaw::PositionCount, state.positions_W.size()};
  }
  return {};
}

bool are_plausible(const std::array<std::uint32_t, 3>& parents, const MapLandmark& child,
                   std::uint32_t next_id) noexcept {
  if (child.xi == 0) {
    return parents == std::array<std::uint32_t, 3>{kNoParent, kNoParent, kNoParent};
  }
  const bool differ = parents[0] != parents[1] && parents[1] != parents[2] && parents[2] != parents[0];
  return differ && std::all_of(parents.begin(), parents.end(),
                               [&](std::uint32_t parent) { return parent < next_id && parent != child.id; });
}

/// A parent that has been pruned or evicted is gone; one that is there stands nearer to the origin.
bool are_nearer(const std::array<std::uint32_t, 3>& parents, std::uint32_t xi,
                std::span<const MapLandmark> landmarks) noexcept {
  return xi == 0 || std::all_of(parents.begin(), parents.end(), [&](std::uint32_t id) {
           const std::optional<std::uint32_t> parent = find_landmark(landmarks, id);
           return !parent || landmarks[*parent].xi < xi;
         });
}

MapFlaw flaw_of_landmark(const MapState& state, std::size_t i) noexcept {
  const MapLandmark& landmark = state.landmarks[i];
  if (landmark.id >= state.next_id) {
    return MapFlaw::NextId;
  }
  if (!on_lattice(state.positions_W[i])) {
    return MapFlaw::Position;
  }
  if (!are_plausible(landmark.parents, landmark, state.next_id)) {
    return MapFlaw::Parents;
  }
  if (landmark.sightings == 0 || landmark.chances == 0) {
    return MapFlaw::Sightings;
  }
  if (!(landmark.sigma_m >= 0.0F) || !std::isfinite(landmark.sigma_m)) {
    return MapFlaw::Sigma;
  }
  if (!landmark.size.is_possible()) {
    return MapFlaw::Size;
  }
  if (landmark.first_scan > landmark.last_scan || landmark.last_scan >= state.scans) {
    return MapFlaw::LandmarkScans;
  }
  return MapFlaw::None;
}

MapCheck check_landmarks(const MapState& state) noexcept {
  const std::span<const MapLandmark> landmarks = state.landmarks;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (i > 0 && landmarks[i].id <= landmarks[i - 1].id) {
      return {MapFlaw::IdOrder, i};
    }
    if (const MapFlaw flaw = flaw_of_landmark(state, i); flaw != MapFlaw::None) {
      return {flaw, i};
    }
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) {  // ids are known to be in order: they can be looked up
    if (!are_nearer(landmarks[i].parents, landmarks[i].xi, landmarks)) {
      return {MapFlaw::ParentXi, i};
    }
  }
  return {};
}

MapCheck check_path(const MapState& state) noexcept {
  for (std::size_t i = 0; i < state.path.size(); ++i) {
    const PathPose& pose = state.path[i];
    if ((i > 0 && pose.scan <= state.path[i - 1].scan) || pose.scan >= state.scans) {
      return {MapFlaw::PathOrder, i};
    }
    const Pose2& p = pose.pose_W;
    if (!std::isfinite(p.x_m) || !std::isfinite(p.y_m) || !std::isfinite(p.heading_rad)) {
      return {MapFlaw::PathPose, i};
    }
  }
  return {};
}

}  // namespace

MapCheck check_map(const MapState& state, const Capacities& capacities) noexcept {
  MapCheck check = check_counts(state, capacities);
  if (check.ok()) {
    check = check_landmarks(state);
  }
  if (check.ok()) {
    check = check_path(state);
  }
  if (check.ok() && state.rates && !state.rates->is_possible()) {
    check.flaw = MapFlaw::Rates;
  }
  return check;
}

MapState state_of(const Hypothesis& hypothesis, std::uint32_t scans) noexcept {
  return {
      hypothesis.map.landmarks(),   hypothesis.map.positions_W(), hypothesis.path.span(), hypothesis.weight,
      hypothesis.landmarks_evicted, hypothesis.path_thinnings,    hypothesis.next_id,     scans};
}

}  // namespace slamsensor::core
