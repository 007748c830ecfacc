#pragma once

#include "core/graph/lattice.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Writes into the lower 32 bits of `keys` the indices of `points` in an order that suits incremental
/// insertion (the biased randomised insertion order of Amenta, Choi and Rote, "Incremental constructions con
/// BRIO", 2003): rounds of doubling size, drawn as if by chance, so that no arrangement of the points is a
/// bad case, and within a round along a Hilbert curve over the bounding square, so that each point is near
/// the one before. `keys` has the length of `points`, `scratch` at least that. The same points in the same
/// order give the same result.
void spatial_order(std::span<const LatticePoint> points, std::span<std::uint64_t> keys,
                   std::span<std::uint64_t> scratch) noexcept;

/// The same for points on one line: in their order along it, points at one place by index.
void line_order(std::span<const LatticePoint> points, std::span<std::uint64_t> keys,
                std::span<std::uint64_t> scratch) noexcept;

}  // namespace slamsensor::core
