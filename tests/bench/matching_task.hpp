#pragma once

#include "core/geometry/pose2.hpp"
#include "tests/support/forest.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace slamsensor::bench {

/// A scan and where it was made. A scan of another forest has no place in the map.
struct Query {
  std::vector<core::Point2> scan_L;
  core::Pose2 truth_W;
};

/// The trees about a place, without a look at all of them. The forest must outlive it.
class Surroundings {
 public:
  explicit Surroundings(const tests::Forest& forest);

  /// The trees of a square about `p` that holds at least the `nearest` nearest ones, if it lies inside the
  /// forest.
  [[nodiscard]] tests::Forest about(const core::Point2& p, std::uint32_t nearest) const;

 private:
  static constexpr double kCell_m = 10.0;

  [[nodiscard]] std::size_t column_of(double v_m) const;

  const tests::Forest& forest_;
  std::size_t columns_;
  std::vector<std::vector<core::Point2>> cells_;
};

/// What stands in the map, and what its scans show of it.
enum class World : std::uint8_t {
  Forest,   ///< trees of 70 m^2 each, at least 1.5 m apart; 30 % of the nearest dropped, a quarter spurious
  Half,     ///< the same forest; half of the nearest dropped, half spurious
  Rows,     ///< trees planted 5 m by 5 m, each 0.4 m beside its place; scans as of the forest
  Foreign,  ///< the map is a forest, the scans are of another one
};

/// A task of ALGORITHMS. The tolerance is 0.5 m, and there is no prior.
struct TaskShape {
  World world = World::Forest;
  std::uint32_t landmarks = 1'000;
  std::uint32_t nearest = 20;  ///< k: landmarks about the sensor that a scan may show
  double sigma_m = 0.15;

  [[nodiscard]] std::string name() const;
};

struct MatchingTask {
  std::vector<core::Point2> map_W;
  std::vector<Query> queries;
};

/// Equal arguments, equal tasks; a longer list of queries begins with the shorter one.
[[nodiscard]] MatchingTask make_matching_task(const TaskShape& shape, std::size_t queries);

}  // namespace slamsensor::bench
