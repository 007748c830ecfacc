#pragma once

#include "tools/world/footprints.hpp"
#include "tools/world/ground.hpp"
#include "tools/world/objects.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <vector>

namespace slamsensor::tools {

/// What stands in a world, and what did not find room.
struct Population {
  std::vector<Object> objects;      ///< given stems, rows, trees, rocks, bushes, posts, in this order
  std::vector<MoverConfig> movers;  ///< the given ones, then those drawn by chance
  Footprints footprints;
  std::uint32_t unplaced = 0;  ///< objects and movers that chance found no place for
};

/// Fills the area of `config` (which is valid): random objects keep `area.clearance_m` between footprints and
/// the spacing of their kind between centres, and stay off walls. Given stems and rows are taken as they are,
/// but those outside the area are left out. Each kind has its own random stream. Dart throwing with a bounded
/// number of darts.
[[nodiscard]] Population populate(const WorldConfig& config, const Ground& ground);

}  // namespace slamsensor::tools
