#pragma once

#include "core/association/rigid_fit.hpp"
#include "core/config.hpp"
#include "core/mapping/landmark_map.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// What a localised scan brings to a map.
struct ScanInMap {
  Pose2 pose_W;
  std::span<const Match> matches;           ///< by increasing scan landmark
  std::span<const Point2> scan_L;           ///< all landmarks of the scan
  std::array<std::uint32_t, 3> triangle{};  ///< map indices of the landmarks that triangulated it
  std::uint32_t number = 0;
};

/// The paper's Algorithm 1 (DESIGN 2.5): brings scans into a map and keeps each landmark's error xi, the
/// number of triangulations between it and the origin.
class PositionalError {
 public:
  PositionalError(Arena& arena, const MappingConfig& config, const Capacities& capacities) noexcept;

  /// xi of a scan: 1 + the largest xi of the three landmarks that triangulated it.
  [[nodiscard]] static std::uint32_t of_scan(const LandmarkMap& map,
                                             const std::array<std::uint32_t, 3>& triangle) noexcept;

  /// Updates the matched landmarks and, when configured, what was triangulated from those that moved. Adds
  /// nothing. The map's index is out of date afterwards. Returns the scan's xi.
  std::uint32_t update_matched(const ScanInMap& scan, LandmarkMap& map) noexcept;

 private:
  void propagate(std::uint32_t scan_xi, LandmarkMap& map) noexcept;

  MappingConfig config_;
  BoundedVector<Point2> before_W_;  // positions before the update
};

}  // namespace slamsensor::core
