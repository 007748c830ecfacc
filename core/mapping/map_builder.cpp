#include "core/mapping/map_builder.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace slamsensor::core {
namespace {

/// Grows with the share of chances that were sightings; long unseen landmarks come last among equals.
double usefulness_of(const MapLandmark& landmark, std::uint32_t scan) noexcept {
  const double age = static_cast<double>(scan - landmark.last_scan) + 1.0;
  return static_cast<double>(landmark.sightings) / static_cast<double>(landmark.chances) - 1e-9 * age;
}

void add_to_path(const PathPose& pose, Hypothesis& hypothesis) noexcept {
  if (!hypothesis.path.try_push_back(pose)) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < hypothesis.path.size(); i += 2) {
      hypothesis.path[kept++] = hypothesis.path[i];
    }
    hypothesis.path.truncate(kept);
    ++hypothesis.path_thinnings;
    SLAMSENSOR_ASSERT(hypothesis.path.try_push_back(pose));
  }
}

}  // namespace

MapBuilder::MapBuilder(Arena& arena, const Config& config) noexcept
    : config_(config),
      positional_error_(arena, config.mapping, config.capacities),
      pruning_(arena, config.mapping, config.capacities),
      delaunay_(arena, config.capacities.map_landmarks),
      drop_(arena, "mapping: evicted", config.capacities.map_landmarks),
      usefulness_(arena, "mapping: usefulness", config.capacities.map_landmarks) {
}

void MapBuilder::start(std::span<const Point2> scan_L, std::uint32_t scan, Hypothesis& hypothesis) noexcept {
  hypothesis.clear();
  const ScanInMap first{Pose2{}, {}, scan_L, {}, scan};
  constexpr std::array<std::uint32_t, 3> kNone{MapLandmark::kNoParent, MapLandmark::kNoParent,
                                               MapLandmark::kNoParent};
  add_unmatched(first, 0, kNone, hypothesis);
  add_to_path({scan, 0, Pose2{}}, hypothesis);
  hypothesis.map.rebuild_index(delaunay_, config_.association);
}

void MapBuilder::extend(std::span<const Point2> scan_L, const Candidate& candidate, std::uint32_t scan,
                        Hypothesis& hypothesis) noexcept {
  const ScanInMap placed{candidate.pose_W, candidate.matches, scan_L, candidate.triangle, scan};
  std::array<std::uint32_t, 3> parents;
  std::transform(candidate.triangle.begin(), candidate.triangle.end(), parents.begin(),
                 [&](std::uint32_t index) { return hypothesis.map.landmarks()[index].id; });
  const std::uint32_t scan_xi = positional_error_.update_matched(placed, hypothesis.map);
  pruning_.apply(placed, hypothesis.map);
  add_unmatched(placed, scan_xi, parents, hypothesis);
  hypothesis.weight += candidate.matches.size();
  add_to_path({scan, scan_xi, candidate.pose_W}, hypothesis);
  hypothesis.map.rebuild_index(delaunay_, config_.association);
}

void MapBuilder::restore(const MapState& state, Hypothesis& hypothesis) noexcept {
  hypothesis.clear();
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    SLAMSENSOR_ASSERT(hypothesis.map.try_add(state.landmarks[i], state.positions_W[i]));
  }
  SLAMSENSOR_ASSERT(hypothesis.path.assign(state.path));
  hypothesis.weight = state.weight;
  hypothesis.next_id = state.next_id;
  hypothesis.landmarks_evicted = state.landmarks_evicted;
  hypothesis.path_thinnings = state.path_thinnings;
  hypothesis.map.rebuild_index(delaunay_, config_.association);
}

void MapBuilder::add_unmatched(const ScanInMap& scan, std::uint32_t scan_xi,
                               const std::array<std::uint32_t, 3>& parents, Hypothesis& hypothesis) noexcept {
  make_room(static_cast<std::uint32_t>(scan.scan_L.size() - scan.matches.size()), scan.number, hypothesis);
  std::size_t match = 0;
  for (std::uint32_t i = 0; i < scan.scan_L.size(); ++i) {
    if (match < scan.matches.size() && scan.matches[match].scan == i) {
      ++match;
      continue;
    }
    MapLandmark landmark;
    landmark.id = hypothesis.next_id++;
    landmark.xi = scan_xi;
    landmark.parents = parents;
    landmark.first_scan = landmark.last_scan = scan.number;
    // Room was made, unless the map holds fewer landmarks than a scan: then the rest of the scan stays out of
    // it.
    if (!hypothesis.map.try_add(landmark, scan.pose_W * scan.scan_L[i])) {
      ++hypothesis.landmarks_evicted;
    }
  }
}

void MapBuilder::make_room(std::uint32_t wanted, std::uint32_t scan, Hypothesis& hypothesis) noexcept {
  const std::uint32_t capacity = config_.capacities.map_landmarks;
  const std::uint32_t size = hypothesis.map.size();
  if (size + wanted <= capacity || size == 0) {
    return;
  }
  const std::uint32_t excess = std::min(size, size + wanted - capacity);
  SLAMSENSOR_ASSERT(drop_.try_resize(size) && usefulness_.try_resize(size));
  for (std::uint32_t i = 0; i < size; ++i) {
    usefulness_[i] = usefulness_of(hypothesis.map.landmarks()[i], scan);
    drop_[i] = false;
  }
  for (std::uint32_t dropped = 0; dropped < excess; ++dropped) {
    const auto* const least = std::min_element(usefulness_.begin(), usefulness_.end());
    const auto index = static_cast<std::size_t>(least - usefulness_.begin());
    drop_[index] = true;
    usefulness_[index] = std::numeric_limits<double>::infinity();  // chosen
  }
  hypothesis.map.remove(drop_.span());
  hypothesis.landmarks_evicted += excess;
}

}  // namespace slamsensor::core
