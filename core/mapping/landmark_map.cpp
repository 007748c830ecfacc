#include "core/mapping/landmark_map.hpp"

#include <algorithm>

namespace slamsensor::core {

std::optional<std::uint32_t> find_landmark(std::span<const MapLandmark> landmarks,
                                           std::uint32_t id) noexcept {
  const auto place =
      std::lower_bound(landmarks.begin(), landmarks.end(), id,
                       [](const MapLandmark& l, std::uint32_t wanted) { return l.id < wanted; });
  if (place == landmarks.end() || place->id != id) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(place - landmarks.begin());
}

LandmarkMap::LandmarkMap(Arena& arena, const Capacities& capacities) noexcept
    : landmarks_(arena, "map: landmarks", capacities.map_landmarks),
      positions_W_(arena, "map: positions", capacities.map_landmarks),
      graph_(arena, "map: graph", capacities.map_landmarks, capacities.map_edges),
      grid_(arena, "map: grid", capacities.map_landmarks) {
}

bool LandmarkMap::try_add(const MapLandmark& landmark, const Point2& position_W) noexcept {
  return landmarks_.try_push_back(landmark) && positions_W_.try_push_back(position_W);
}

void LandmarkMap::remove(std::span<const bool> drop) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    if (!drop[i]) {
      landmarks_[kept] = landmarks_[i];
      positions_W_[kept] = positions_W_[i];
      ++kept;
    }
  }
  landmarks_.truncate(kept);
  positions_W_.truncate(kept);
}

void LandmarkMap::rebuild_index(Delaunay& delaunay, const AssociationConfig& config) noexcept {
  // A graph that cannot be built stays empty, and the search then finds nothing: no fix instead of a wrong
  // one.
  (void)graph_.build(positions_W_.span(), delaunay, config.depth);
  grid_.build(positions_W_.span(), 2.0 * config.tolerance_m);
}

void LandmarkMap::copy_from(const LandmarkMap& other) noexcept {
  SLAMSENSOR_ASSERT(landmarks_.assign(other.landmarks_.span()) &&
                    positions_W_.assign(other.positions_W_.span()));
  graph_.copy_from(other.graph_);
  grid_.copy_from(other.grid_, positions_W_.span());
}

void LandmarkMap::clear() noexcept {
  landmarks_.clear();
  positions_W_.clear();
}

}  // namespace slamsensor::core
