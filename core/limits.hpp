#pragma once

#include <cstddef>
#include <cstdint>

namespace slamsensor::core {

// Compile-time bounds; everything that grows with the world is a run-time capacity instead (config.hpp).

/// Landmarks of one scan that association takes: the paper uses 20 to 30; the densest forest frame measured
/// has 92.
inline constexpr std::uint32_t kScanLandmarksMax = 128;

/// Poses that a search keeps: a bit each in a 32-bit mask per correspondence vertex.
inline constexpr std::uint32_t kCandidatesMax = 32;

/// Lambda_max: the paper keeps 3; each costs a whole map.
inline constexpr std::uint32_t kHypothesesMax = 8;

/// Neighbours of one correspondence vertex that are combined to triangles: about 40 in a uniform world.
inline constexpr std::uint32_t kVertexNeighboursMax = 1024;

}  // namespace slamsensor::core
