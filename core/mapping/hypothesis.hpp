#pragma once

#include "core/config.hpp"
#include "core/mapping/landmark_map.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>

namespace slamsensor::core {

/// A place of the sensor on a hypothesis' path.
struct PathPose {
  std::uint32_t scan = 0;
  std::uint32_t xi = 0;
  Pose2 pose_W;
};

/// One history of the sensor (DESIGN 2.4): its map, its path and the matches it has gathered.
struct Hypothesis {
  Hypothesis(Arena& arena, const Capacities& capacities) noexcept
      : map(arena, capacities), path(arena, "map: path", capacities.path_poses) {}

  LandmarkMap map;
  BoundedVector<PathPose> path;
  std::uint64_t weight = 0;             ///< W, the accumulated match count
  std::uint32_t next_id = 0;            ///< of the next new landmark
  std::uint64_t landmarks_evicted = 0;  ///< made room for others because the map was full
  std::uint64_t path_thinnings = 0;     ///< times that every other pose of a full path was dropped

  void copy_from(const Hypothesis& other) noexcept {
    map.copy_from(other.map);
    SLAMSENSOR_ASSERT(path.assign(other.path.span()));
    weight = other.weight;
    next_id = other.next_id;
    landmarks_evicted = other.landmarks_evicted;
    path_thinnings = other.path_thinnings;
  }

  void clear() noexcept {
    map.clear();
    path.clear();
    weight = landmarks_evicted = path_thinnings = 0;
    next_id = 0;
  }
};

}  // namespace slamsensor::core
