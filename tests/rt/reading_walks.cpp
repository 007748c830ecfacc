#include "tests/rt/reading_walks.hpp"

#include "tests/rt/walk_parts.hpp"
#include "tests/support/forest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

namespace slamsensor::tests {
namespace {

using core::Fix;
using core::FixStatus;
using core::Slam;

/// The range to the nearest of the trees (m, radius 0.3 m) along a bearing, or no return within 40 m.
double range_to_tree_m(const std::vector<core::Point2>& trees_L, double pan_rad) {
  constexpr double kRadius_m = 0.3;
  double nearest_m = 40.0;
  const core::Point2 direction(std::cos(pan_rad), std::sin(pan_rad));
  for (const core::Point2& tree : trees_L) {
    const double along_m = tree.dot(direction);
    const double half_chord2_m2 = kRadius_m * kRadius_m - (tree.squaredNorm() - along_m * along_m);
    if (along_m > 0.0 && half_chord2_m2 >= 0.0) {
      nearest_m = std::min(nearest_m, along_m - std::sqrt(half_chord2_m2));
    }
  }
  return nearest_m < 40.0 ? nearest_m : core::Reading::kNoReturn;
}

}  // namespace

/// Readings of trees: a full turn of 0.1 deg at each tilt, and now and then a reading that is none.
Walk readings_walk(core::LandmarkPoint point, std::uint32_t cells) {
  Draw draw(kSeed + 5);
  const Forest forest = make_forest(120, draw);
  core::Config config = small_config();
  config.detection.point = point;
  config.detection.discard_share = 0.0;
  config.capacities.occupied_cells = cells;
  const auto expect = [](const Walk& walk, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GE(count(fixes, FixStatus::Fix), 4);
    EXPECT_GE(fixes.back().landmarks_seen, 15U);
    EXPECT_GT(slam.detector().readings_refused(), 0U);
    EXPECT_EQ(slam.detector().cells_dropped() > 0, walk.config.capacities.occupied_cells < 1000);
  };
  Walk walk{config, {}, expect};
  for (int i = 0; i < 6; ++i) {
    const core::Pose2 pose_W{0.8 * i, -0.5 * i, 0.2 * i};
    std::vector<core::Point2> trees_L;
    std::transform(forest.trees_W.begin(), forest.trees_W.end(), std::back_inserter(trees_L),
                   [&](const core::Point2& tree_W) { return pose_W.inverse() * tree_W; });
    WalkScan scan;
    for (int line = 0; line < 5; ++line) {
      std::vector<core::Reading>& readings = scan.scanlines.emplace_back();
      for (int shot = 0; shot < 3600; ++shot) {
        const double pan_rad = 2.0 * std::numbers::pi * shot / 3600.0;
        readings.push_back({pan_rad, 0.01 * line, range_to_tree_m(trees_L, pan_rad)});
      }
      readings[draw.below(3600)].range_m = std::numeric_limits<double>::quiet_NaN();
      readings[draw.below(3600)].pan_rad = std::numeric_limits<double>::infinity();
    }
    scan.scanlines.emplace_back();  // an empty scanline
    walk.scans.push_back(scan);
  }
  return walk;
}

}  // namespace slamsensor::tests
