// Maps that come from outside and go there: files, surveys.
#include "core/graph/lattice.hpp"
#include "core/mapping/atlas.hpp"
#include "core/mapping/atlas_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace slamsensor::core {
namespace {

constexpr std::uint32_t kSurveyed = 10;  // sightings that a surveyed place counts as ...
constexpr std::uint32_t kSurveyedChances =
    16;  // ... and chances: a survey says nothing of how often it is shown

/// A survey leaves out nothing beside a landmark.
void look_about(const Point2& landmark_W, ExploredGround& ground) noexcept {
  for (const double dy : {-kSurveyedAbout_m, 0.0, kSurveyedAbout_m}) {
    for (const double dx : {-kSurveyedAbout_m, 0.0, kSurveyedAbout_m}) {
      ground.look(0, landmark_W + Point2(dx, dy), 0.9);
    }
  }
}

}  // namespace

bool Atlas::take_survey(std::span<const Point2> landmarks_W, std::span<const LandmarkSize> sizes) noexcept {
  reset();
  if (landmarks_W.size() > config_.capacities.map_landmarks) {
    return false;
  }
  home_ = 0;
  maps_[0].number = ++maps_made_;
  maps_[0].scans = 2;
  for (std::size_t i = 0; i < landmarks_W.size(); ++i) {
    const Point2& p_W = landmarks_W[i];
    const std::uint32_t slot = graph_.add_landmark(0, p_W, 0, 0);
    SLAMSENSOR_ASSERT(slot != SightingGraph::kNone);
    graph_.standing(slot) = {kSurveyed, kSurveyedChances, sizes.empty() ? LandmarkSize{} : sizes[i]};
    graph_.set_prior(slot, kSurveyed);
    graph_.landmark(slot).file_sigma_m = 0.0F;
    ++maps_[0].landmarks;
    ++maps_[0].confirmed;
    look_about(p_W, ground_);
  }
  is_surveyed_ = true;
  probe_structure();
  return true;
}

/// Learns how far a map repeats itself, from samples of its own places.
void Atlas::probe_structure() noexcept {
  constexpr std::uint32_t kProbes = 64;
  constexpr double kProbeReach_m = 20.0;
  const std::uint32_t step = std::max(1U, graph_.slots() / kProbes);
  for (std::uint32_t slot = 0; slot < graph_.slots(); slot += step) {
    const Point2 middle = graph_.positions()[slot];
    points_B_.clear();
    points_L_.clear();
    sizes_.clear();
    graph_.index().visit_within(home_, middle, kProbeReach_m, [&](std::uint32_t other, double) {
      if (points_B_.size() < kProbeLandmarks) {
        SLAMSENSOR_ASSERT(points_B_.try_push_back(graph_.positions()[other] - middle) &&
                          sizes_.try_push_back(graph_.standing(other).size));
      }
    });
    ScanView view;
    scan_.view = &view;
    scan_.reach_m = kProbeReach_m;
    // By the fast search in any case: the paper's may take minutes for this.
    fast_.search(points_B_.span(), graph_.index(), graph_.positions(), kNoMap, scan_model(), {}, found_[0]);
    weigh(scan_witnesses(), found_[0], weighed_);
    const std::size_t best = best_in(weighed_.span(), home_);
    if (best != SIZE_MAX) {
      learn_structure(best, step);
    }
  }
  scan_.view = nullptr;
  weighed_.clear();
}

/// Three errors: of the mean of its sightings, of the map where it was seen (its drift), and of the frame,
/// which turns and bends. What came from a file keeps the sigma that it came with: a restart is no sighting.
double Atlas::landmark_sigma_m(std::uint32_t slot) const noexcept {
  const GraphLandmark& l = graph_.landmark(slot);
  if (l.file_sigma_m >= 0.0F) {
    return static_cast<double>(l.file_sigma_m);
  }
  const double sighting_m = rates_.sigma_m(scale_.start_sigma_m());
  const double own_m2 = (sighting_m * sighting_m + kScanBias_m * kScanBias_m) / std::max(1.0, l.sum_weight);
  const Point2& place_W = graph_.positions()[slot];
  double drift_m2 = 0.0;
  if (const std::uint32_t pose = graph_.witness_of(slot); pose != SightingGraph::kNone) {
    const Eigen::Matrix3d drift = graph_.drift_of(pose);
    const double arm2_m2 = (place_W - graph_.pose(pose).T_W_B.translation()).squaredNorm();
    drift_m2 =
        sighting_m * sighting_m * kDriftInflation * (drift(0, 0) + drift(1, 1) + drift(2, 2) * arm2_m2);
  }
  const double turn2 = maps_[l.map].frame_turn2 + 3.0 * kFrameBias_rad * kFrameBias_rad;
  return std::sqrt(own_m2 + 0.5 * (drift_m2 + turn2 * place_W.squaredNorm()));
}

MapState Atlas::copy_home(const MapRoom& room) const noexcept {
  MapState state;
  state.scans = scans_;
  state.next_id = graph_.next_id();
  state.landmarks_evicted = landmarks_evicted_;
  state.path_thinnings = graph_.poses_folded();
  state.is_surveyed = is_surveyed_;
  if (home_ == kNoMap) {
    return state;
  }
  state.weight = maps_[home_].W;
  state.rates = is_surveyed_ ? std::nullopt : std::optional(rates_);
  std::size_t count = 0;
  for (std::uint32_t slot = 0; slot < graph_.slots() && count < room.landmarks.size(); ++slot) {
    if (!graph_.is_used(slot) || graph_.landmark(slot).map != home_) {
      continue;
    }
    const GraphLandmark& l = graph_.landmark(slot);
    const Standing& standing = graph_.standing()[slot];
    room.landmarks[count] = {l.id,
                             l.xi,
                             l.parents,
                             standing.sightings,
                             standing.chances,
                             l.first_scan,
                             l.last_scan,
                             static_cast<float>(landmark_sigma_m(slot)),
                             standing.size};
    // Two numbers share the array until it is sorted: the slot stands where the place will.
    room.positions_W[count] = {static_cast<double>(l.id), static_cast<double>(slot)};
    ++count;
  }
  const std::span<MapLandmark> landmarks = room.landmarks.first(count);
  const std::span<Point2> positions = room.positions_W.first(count);
  std::sort(landmarks.begin(), landmarks.end(),
            [](const MapLandmark& a, const MapLandmark& b) { return a.id < b.id; });
  std::sort(positions.begin(), positions.end(),
            [](const Point2& a, const Point2& b) { return a.x() < b.x(); });
  for (Point2& p : positions) {
    p = graph_.positions()[static_cast<std::size_t>(p.y())];
  }
  state.landmarks = landmarks;
  state.positions_W = positions;
  state.path = copy_path(room.path);
  return state;
}

/// The poses of the home map, after those from before a restart; of these the latest, as far as there is
/// room.
std::span<const PathPose> Atlas::copy_path(std::span<PathPose> path) const noexcept {
  std::size_t poses = 0;
  graph_.visit_poses([&](std::uint32_t, const GraphPose& pose) { poses += pose.map == home_ ? 1 : 0; });
  const std::size_t before = maps_[home_].number == restored_map_
                                 ? std::min(path_before_.size(), path.size() - std::min(poses, path.size()))
                                 : 0;
  const auto kept = path_before_.span().last(before);
  std::copy(kept.begin(), kept.end(), path.begin());
  std::size_t count = before;
  graph_.visit_poses([&](std::uint32_t, const GraphPose& pose) {
    if (pose.map == home_ && count < path.size() && (count == 0 || pose.scan > path[count - 1].scan)) {
      path[count++] = {pose.scan, pose.xi, pose.T_W_B};
    }
  });
  return path.first(count);
}

MapCheck Atlas::restore(const MapState& state) noexcept {
  const MapCheck check = check_map(state, config_.capacities);
  if (!check.ok()) {
    return check;
  }
  jumps_ += home_ != kNoMap ? 1 : 0;
  const std::uint32_t jumps = jumps_;
  reset();
  jumps_ = jumps;
  home_ = 0;
  has_fixed_ = true;  // the frame is known from before
  MapEntry& entry = maps_[0];
  entry.number = restored_map_ = ++maps_made_;
  SLAMSENSOR_ASSERT(path_before_.try_resize(state.path.size()));
  std::copy(state.path.begin(), state.path.end(), path_before_.begin());
  entry.scans = std::max(2U, static_cast<std::uint32_t>(state.path.size()));
  entry.W = state.weight;
  scans_ = state.scans;
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    const MapLandmark& from = state.landmarks[i];
    graph_.set_next_id(from.id);
    const std::uint32_t slot = graph_.add_landmark(0, state.positions_W[i], from.first_scan, from.xi);
    SLAMSENSOR_ASSERT(slot != SightingGraph::kNone);
    GraphLandmark& l = graph_.landmark(slot);
    l.last_scan = from.last_scan;
    l.parents = from.parents;
    const std::uint32_t sightings = state.is_surveyed ? std::max(from.sightings, kSurveyed) : from.sightings;
    graph_.standing(slot) = {
        sightings, std::max(from.chances, state.is_surveyed ? kSurveyedChances : sightings), from.size};
    graph_.set_prior(slot, sightings);
    l.file_sigma_m = from.sigma_m;
    ++entry.landmarks;
    entry.confirmed += sightings >= 2 ? 1 : 0;
    if (state.is_surveyed) {
      look_about(state.positions_W[i], ground_);
    } else {
      ground_.look(0, state.positions_W[i], 0.9);  // where landmarks are, somebody looked
    }
  }
  graph_.set_next_id(state.next_id);
  landmarks_evicted_ = state.landmarks_evicted;
  is_surveyed_ = state.is_surveyed;
  if (state.rates && !is_surveyed_) {
    rates_ = *state.rates;
    if (rates_.offset_m != 0.0) {
      graph_.know_offset(rates_.offset_m);
    }
  } else {
    probe_structure();
  }
  return check;
}

}  // namespace slamsensor::core
