#include "core/mapping/hypothesis_set.hpp"

#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

Config test_config() {
  Config c;
  c.capacities.map_landmarks = 600;
  c.capacities.map_edges = 8000;
  c.capacities.scan_landmarks = 40;
  c.capacities.path_poses = 200;
  return c;
}

Fix process(HypothesisSet& set, const std::vector<Point2>& scan) {
  return set.process(tests::as_landmarks(scan), {});
}

TEST(HypothesisSet, WalksThroughAForestFromNothing) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(150, draw);
    tests::InArena<HypothesisSet> set(test_config());
    Pose2 origin;
    int fixes = 0;
    for (int i = 0; i < 25; ++i) {
      const Pose2 truth{-20.0 + 1.5 * i, 0.4 * i - 5.0, 0.3 * i};
      const Fix fix = process(*set, tests::scan_forest(forest, truth, {24, 0.15, 2, 0.05}, draw));
      if (i == 0) {
        origin = truth;
        EXPECT_EQ(fix.status, FixStatus::Fix);
        EXPECT_EQ(fix.pose_W.x_m, 0.0);
      }
      if (fix.status == FixStatus::Fix) {
        ++fixes;
        EXPECT_TRUE(tests::is_right(origin * fix.pose_W, truth)) << "seed " << seed << " scan " << i;
      }
    }
    EXPECT_GE(fixes, 23) << "seed " << seed;
    EXPECT_GT(set->best().weight, 200U);
  }
}

TEST(HypothesisSet, AKidnappedSensorFindsItselfInItsMap) {
  Draw draw(5);
  const Forest forest = tests::make_forest(60, draw);
  tests::InArena<HypothesisSet> set(test_config());
  const std::vector<Pose2> stands{{-8, -5, 0}, {0, 0, 2}, {8, 5, -2}, {-8, -5, 1}, {7, 4, 3}};
  for (const Pose2& stand : stands) {
    const Fix fix = process(*set, tests::scan_forest(forest, stand, {40, 0.1, 2, 0.05}, draw));
    ASSERT_EQ(fix.status, FixStatus::Fix);
    EXPECT_TRUE(tests::is_right(stands[0] * fix.pose_W, stand));
  }
}

TEST(HypothesisSet, ThePaperRuleTakesTheBestWhateverItIs) {
  Draw draw(7);
  const Forest here = tests::make_forest(60, draw);
  const Forest elsewhere = tests::make_forest(60, draw);
  tests::InArena<HypothesisSet> set(test_config());
  (void)process(*set, tests::scan_forest(here, {}, {}, draw));
  const Fix fix = process(*set, tests::scan_forest(elsewhere, {}, {}, draw));
  EXPECT_EQ(fix.status, FixStatus::Fix);
  EXPECT_LT(fix.matches, 9U);
}

TEST(HypothesisSet, TooFewLandmarksAreSaidSo) {
  tests::InArena<HypothesisSet> set(test_config());
  const Fix fix = process(*set, {Point2(1, 1), Point2(5, 2)});
  EXPECT_EQ(fix.status, FixStatus::NoFix);
  EXPECT_EQ(fix.reason, FixReason::TooFewLandmarks);
  EXPECT_TRUE(set->empty());
}

TEST(HypothesisSet, LandmarksThatAreNoPlacesAreRefusedAndCounted) {
  tests::InArena<HypothesisSet> set(test_config());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Fix fix = process(*set, {Point2(1, 1), Point2(nan, 2), Point2(5, 2), Point2(3, 1e9), Point2(-4, 3)});
  EXPECT_EQ(fix.landmarks_seen, 3U);
  EXPECT_EQ(set->counters().landmarks_refused, 2U);
  EXPECT_EQ(fix.status, FixStatus::Fix);
}

TEST(HypothesisSet, LandmarksBeyondCapacityAreCutFromTheLightEnd) {
  Config config = test_config();
  config.capacities.scan_landmarks = 4;
  tests::InArena<HypothesisSet> set(config);
  const Fix fix = process(*set, {{1, 1}, {5, 2}, {-4, 3}, {2, 9}, {7, 7}, {8, 1}});
  EXPECT_EQ(fix.landmarks_seen, 4U);
  EXPECT_EQ(set->counters().landmarks_cut, 2U);
  EXPECT_EQ(set->best().map.size(), 4U);
}

TEST(HypothesisSet, KeepsAtMostLambdaMaxRankedByW) {
  Draw draw(8);
  const Forest forest = tests::make_forest(100, draw);
  Config config = test_config();
  config.association.tolerance_m = 1.0;
  tests::InArena<HypothesisSet> set(config);
  Fix fix;
  for (int i = 0; i < 10; ++i) {
    fix = process(*set, tests::scan_forest(forest, {1.0 * i - 5.0, 0, 0}, {24, 0.2, 3, 0.2}, draw));
    EXPECT_GE(fix.weight_best, fix.weight_runner_up);
  }
  EXPECT_GT(fix.weight_runner_up, 0U);
}

TEST(HypothesisSet, TheMountCarriesScansToTheBody) {
  Draw draw(9);
  const Forest forest = tests::make_forest(60, draw);
  Config config = test_config();
  config.mount = {3.0, 0.5, 0.2};
  const Pose2 T_B_L{3.0, 0.5, 0.2};
  tests::InArena<HypothesisSet> set(config);
  // The body turns on the spot: its own pose does not move although the sensor swings around it.
  for (int i = 0; i < 8; ++i) {
    const Pose2 T_W_B{0.0, 0.0, 0.8 * i};
    const Fix fix = process(*set, tests::scan_forest(forest, T_W_B * T_B_L, {30, 0.0, 0, 0.0}, draw));
    ASSERT_EQ(fix.status, FixStatus::Fix);
    EXPECT_NEAR(fix.pose_W.translation().norm(), 0.0, 1e-6) << "turn " << i;
    EXPECT_NEAR(wrap_angle(fix.pose_W.heading_rad - 0.8 * i), 0.0, 1e-6);
  }
}

TEST(HypothesisSet, ResetStartsANewMap) {
  Draw draw(10);
  const Forest forest = tests::make_forest(60, draw);
  tests::InArena<HypothesisSet> set(test_config());
  (void)process(*set, tests::scan_forest(forest, {4, 4, 1}, {}, draw));
  set->reset();
  EXPECT_TRUE(set->empty());
  const Fix fix = process(*set, tests::scan_forest(forest, {-4, 4, 2}, {}, draw));
  EXPECT_EQ(fix.scan, 0U);
  EXPECT_EQ(fix.pose_W.x_m, 0.0);
}

TEST(HypothesisSet, TheSameScansGiveTheSameFixes) {
  const auto run = [] {
    Draw draw(11);
    const Forest forest = tests::make_forest(100, draw);
    tests::InArena<HypothesisSet> set(test_config());
    std::vector<double> numbers;
    for (int i = 0; i < 10; ++i) {
      const Fix fix = process(*set, tests::scan_forest(forest, {1.0 * i, 0, 0.1 * i}, {}, draw));
      numbers.insert(numbers.end(), {fix.pose_W.x_m, fix.pose_W.heading_rad, fix.expected_false_alarms});
    }
    return numbers;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace slamsensor::core
