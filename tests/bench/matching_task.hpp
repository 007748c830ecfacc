#pragma once

#include "core/geometry/pose2.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::bench {

/// A scan and where it was made. A scan of another forest has no place in the map.
struct Query {
  std::vector<core::Point2> scan_L;
  core::Pose2 truth_W;
};

/// The task of ALGORITHMS: a map of n trees (70 m^2 each, 1.5 m apart), scans of the 20 nearest of which 30 %
/// are dropped, 5 spurious points added, noise 0.15 m, tolerance 0.5 m, no prior.
struct MatchingTask {
  std::vector<core::Point2> map_W;
  std::vector<Query> queries;  ///< scans of the map's forest
  std::vector<Query> foreign;  ///< scans of another forest of the same kind
};

/// Equal arguments, equal tasks; a longer list of queries begins with the shorter one.
[[nodiscard]] MatchingTask make_matching_task(std::uint32_t landmarks, std::size_t queries,
                                              std::size_t foreign);

}  // namespace slamsensor::bench
