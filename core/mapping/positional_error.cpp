#include "core/mapping/positional_error.hpp"

#include <algorithm>

namespace slamsensor::core {
namespace {

/// The rigid motion that carries the places of three parents before an update to those after it; none when a
/// parent is gone or none of them moved.
std::optional<Pose2> motion_of_parents(const MapLandmark& landmark, std::span<const Point2> before_W,
                                       const LandmarkMap& map) noexcept {
  std::array<Match, 3> pairs;
  bool moved = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<std::uint32_t> parent = map.find(landmark.parents[i]);
    if (!parent) {
      return std::nullopt;
    }
    pairs[i] = {*parent, *parent};
    moved = moved || before_W[*parent] != map.positions_W()[*parent];
  }
  return moved ? fit_pose(pairs, before_W, map.positions_W()) : std::nullopt;
}

}  // namespace

PositionalError::PositionalError(Arena& arena, const MappingConfig& config,
                                 const Capacities& capacities) noexcept
    : config_(config), before_W_(arena, "mapping: positions before", capacities.map_landmarks) {
}

std::uint32_t PositionalError::of_scan(const LandmarkMap& map,
                                       const std::array<std::uint32_t, 3>& triangle) noexcept {
  std::uint32_t largest = 0;
  for (const std::uint32_t index : triangle) {
    largest = std::max(largest, map.landmarks()[index].xi);
  }
  return largest + 1;
}

std::uint32_t PositionalError::update_matched(const ScanInMap& scan, LandmarkMap& map) noexcept {
  const std::uint32_t scan_xi = of_scan(map, scan.triangle);
  std::array<std::uint32_t, 3> parents;
  std::transform(scan.triangle.begin(), scan.triangle.end(), parents.begin(),
                 [&](std::uint32_t index) { return map.landmarks()[index].id; });
  if (config_.propagate_corrections) {
    SLAMSENSOR_ASSERT(before_W_.assign(map.positions_W()));
  }
  for (const Match& m : scan.matches) {
    MapLandmark& landmark = map.landmark(m.map);
    Point2& position_W = map.position_W(m.map);
    const Point2 seen_W = scan.pose_W * scan.scan_L[m.scan];
    ++landmark.sightings;
    landmark.last_scan = scan.number;
    if (config_.update == LandmarkUpdate::Mean) {
      position_W += (seen_W - position_W) / static_cast<double>(landmark.sightings);
    }
    if (landmark.xi >= scan_xi) {
      if (config_.update == LandmarkUpdate::Paper) {
        position_W = seen_W;
      }
      landmark.xi = scan_xi;
      landmark.parents = parents;
    }
  }
  if (config_.propagate_corrections) {
    propagate(scan_xi, map);
  }
  return scan_xi;
}

/// Carries corrections on, level by level: the parents of a landmark have a smaller xi, so a level is final
/// before the next one asks for it, and no recursion is needed.
void PositionalError::propagate(std::uint32_t scan_xi, LandmarkMap& map) noexcept {
  std::uint32_t xi_max = 0;
  for (const MapLandmark& landmark : map.landmarks()) {
    xi_max = std::max(xi_max, landmark.xi);
  }
  for (std::uint32_t xi = scan_xi + 1; xi <= xi_max; ++xi) {
    for (std::uint32_t i = 0; i < map.size(); ++i) {
      if (map.landmarks()[i].xi != xi) {
        continue;
      }
      if (const auto motion = motion_of_parents(map.landmarks()[i], before_W_.span(), map)) {
        map.position_W(i) = *motion * map.positions_W()[i];
      }
    }
  }
}

}  // namespace slamsensor::core
