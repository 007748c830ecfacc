// Scans against a map that was surveyed and never changes.
#include "core/localizer.hpp"

#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

Config localizer_config(SearchMethod search) {
  Config c;
  c.association.search = search;
  c.association.order_share = 1.0;
  c.capacities.map_landmarks = 500;
  c.capacities.map_edges = 8'000;
  c.capacities.path_poses = 4;
  c.capacities.sightings = 100;
  return c;
}

/// The map that a sensor made of `forest`, or that somebody surveyed, as a file keeps it.
struct Kept {
  explicit Kept(const Forest& forest) : positions_W(forest.trees_W) {
    for (std::size_t i = 0; i < positions_W.size(); ++i) {
      MapLandmark landmark;
      landmark.id = static_cast<std::uint32_t>(i);
      landmark.sightings = 5;  // as often as its scans show it
      landmark.chances = 7;
      landmarks.push_back(landmark);
    }
  }
  MapState state(bool is_surveyed) const {
    MapState state;
    state.landmarks = landmarks;
    state.positions_W = positions_W;
    state.next_id = static_cast<std::uint32_t>(landmarks.size());
    state.scans = 1;
    state.is_surveyed = is_surveyed;
    return state;
  }

  std::vector<Point2> positions_W;
  std::vector<MapLandmark> landmarks;
};

class LocalizerBySearch : public testing::TestWithParam<SearchMethod> {
 protected:
  Fix locate(const std::vector<Point2>& scan) { return localizer->locate(tests::as_landmarks(scan), {}, {}); }

  tests::InArena<Localizer> localizer{localizer_config(GetParam())};
};

INSTANTIATE_TEST_SUITE_P(Searches, LocalizerBySearch,
                         testing::Values(SearchMethod::Fast, SearchMethod::Paper), [](const auto& search) {
                           return search.param == SearchMethod::Fast ? "Fast" : "Paper";
                         });

// A wrong pose marked valid is the worst thing: scans of another forest must not be believed.
TEST_P(LocalizerBySearch, ForeignScansAreRefused) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Draw draw(1000 + seed);
    const Forest here = tests::make_forest(180, draw);
    const Forest elsewhere = tests::make_forest(180, draw);
    ASSERT_TRUE(localizer->set_map(here.trees_W));
    int accepted = 0;
    for (int i = 0; i < 100; ++i) {
      const Fix fix = locate(tests::scan_forest(elsewhere, tests::pose_in(elsewhere, draw), {}, draw));
      accepted += fix.status == FixStatus::Fix ? 1 : 0;
    }
    EXPECT_EQ(accepted, 0) << "seed " << seed;
  }
}

// In a dense map some place has a landmark near most points of any scan: what such a place has and the scan
// does not show speaks against it. One in thirty of these was a fix in a survey.
TEST(Localizer, PointsByChanceAreNowhereInADenseMap) {
  Draw draw(26);
  Config config = localizer_config(SearchMethod::Fast);
  config.capacities.map_landmarks = 4'000;
  config.capacities.map_edges = 64'000;
  Forest forest = tests::make_forest(3'500, draw);
  for (Point2& p_W : forest.trees_W) {
    p_W *= 0.5;
  }
  const auto anywhere = [](Draw& from) { return from.uniform(-35.0, 35.0); };
  for (const bool is_surveyed : {true, false}) {
    tests::InArena<Localizer> localizer(config);
    ASSERT_TRUE(localizer->restore(Kept(forest).state(is_surveyed)).ok());
    int accepted = 0;
    for (int i = 0; i < 150; ++i) {
      std::vector<Point2> scan;
      for (int k = 0; k < 28; ++k) {
        const double x_m = anywhere(draw);
        scan.emplace_back(x_m, anywhere(draw));
      }
      accepted += localizer->locate(tests::as_landmarks(scan), {}, {}).status == FixStatus::Fix ? 1 : 0;
    }
    EXPECT_EQ(accepted, 0) << (is_surveyed ? "survey" : "driven");
  }
}

TEST_P(LocalizerBySearch, TrueScansAreAcceptedWithTheirPose) {
  Draw draw(2000);
  const Forest forest = tests::make_forest(180, draw);
  ASSERT_TRUE(localizer->set_map(forest.trees_W));
  int accepted = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose2 truth = tests::pose_in(forest, draw);
    const Fix fix = locate(tests::scan_forest(forest, truth, {}, draw));
    if (fix.status == FixStatus::Fix) {
      ++accepted;
      EXPECT_TRUE(tests::is_right(fix.pose_W, truth)) << "query " << i;
    }
  }
  EXPECT_GE(accepted, 95);
}

TEST_P(LocalizerBySearch, TwoCopiesOfAPlaceAreAmbiguous) {
  Draw draw(15);
  Forest forest = tests::make_forest(30, draw);
  const Forest one = forest;
  for (const Point2& p : one.trees_W) {
    forest.trees_W.push_back(p + Point2(200.0, 30.0));
  }
  ASSERT_TRUE(localizer->set_map(forest.trees_W));
  const Fix fix = locate(tests::scan_forest(one, {0, 0, 0.4}, {}, draw));
  EXPECT_EQ(fix.status, FixStatus::Ambiguous);
  EXPECT_EQ(fix.reason, FixReason::Symmetric);
}

// A map that a sensor made of a part of the world was taken for all of it: a copse just like one in it, and
// never mapped, was a fix there.
TEST_P(LocalizerBySearch, AMapThatASensorMadeLeavesRoomForACopyOutsideOfIt) {
  Draw draw(25);
  const Forest copse = tests::make_forest(10, draw);
  const Kept kept(copse);
  const auto scan = tests::scan_forest(copse, {1.0, 2.0, 0.4}, {}, draw);
  ASSERT_TRUE(localizer->restore(kept.state(true)).ok());
  EXPECT_EQ(locate(scan).status, FixStatus::Fix) << "a survey leaves nothing out";
  ASSERT_TRUE(localizer->restore(kept.state(false)).ok());
  const Fix driven = locate(scan);
  EXPECT_EQ(driven.status, FixStatus::Ambiguous);
  EXPECT_EQ(driven.reason, FixReason::Copy);
}

TEST_P(LocalizerBySearch, ASurveyThatIsRestoredIsTheSurvey) {
  Draw draw(22);
  const Forest forest = tests::make_forest(60, draw);
  const Kept kept(forest);
  for (int i = 0; i < 5; ++i) {
    const auto scan = tests::scan_forest(forest, tests::pose_in(forest, draw), {}, draw);
    ASSERT_TRUE(localizer->set_map(forest.trees_W));
    const Fix given = locate(scan);
    ASSERT_TRUE(localizer->restore(kept.state(true)).ok());
    const Fix restored = locate(scan);
    EXPECT_EQ(given.status, restored.status) << i;
    EXPECT_EQ(given.pose_W.x_m, restored.pose_W.x_m) << i;
    EXPECT_EQ(given.expected_false_alarms, restored.expected_false_alarms) << i;
  }
  EXPECT_FALSE(localizer->restore(MapState{}).ok());
}

// A plantation looks the same one row on.
TEST_P(LocalizerBySearch, RowsAreNeverAFix) {
  Draw draw(16);
  Forest plantation;
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 9; ++y) {
      plantation.trees_W.push_back(Point2{4.0 * x + draw.normal(0.05), 3.0 * y + draw.normal(0.05)});
    }
  }
  ASSERT_TRUE(localizer->set_map(plantation.trees_W));
  for (int i = 0; i < 3; ++i) {
    const Fix fix = locate(tests::scan_forest(plantation, {16.0 + i, 12.0, 0.2}, {}, draw));
    EXPECT_NE(fix.status, FixStatus::Fix);
  }
}

TEST_P(LocalizerBySearch, NoQueryChangesTheMap) {
  Draw draw(17);
  const Forest forest = tests::make_forest(180, draw);
  const auto scan = tests::scan_forest(forest, {3, 4, 1}, {}, draw);
  for (const bool is_surveyed : {true, false}) {
    ASSERT_TRUE(localizer->restore(Kept(forest).state(is_surveyed)).ok());
    const Fix first = locate(scan);
    for (int i = 0; i < 10; ++i) {
      (void)locate(tests::scan_forest(forest, tests::pose_in(forest, draw), {}, draw));
    }
    const Fix again = locate(scan);
    EXPECT_LT((first.pose_W.translation() - again.pose_W.translation()).norm(), 0.01);
    EXPECT_EQ(first.status, again.status);
    EXPECT_EQ(first.expected_false_alarms == again.expected_false_alarms, !is_surveyed)
        << "a survey teaches how well this sensor measures it";
  }
}

// A sensor that measures worse than is usual finds itself more often once that is known.
TEST(Localizer, ASurveyTeachesHowFarLandmarksScatterAboutIt) {
  Draw draw(28);
  const Forest forest = tests::make_forest(180, draw);
  tests::InArena<Localizer> learning(localizer_config(SearchMethod::Fast));
  tests::InArena<Localizer> fresh(localizer_config(SearchMethod::Fast));
  ASSERT_TRUE(learning->set_map(forest.trees_W));
  int alone = 0;
  int taught = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose2 truth = tests::pose_in(forest, draw);
    const auto scan = tests::as_landmarks(
        tests::scan_forest(forest, truth, {.dropped_share = 0.5, .spurious = 10, .sigma_m = 0.35}, draw));
    ASSERT_TRUE(fresh->set_map(forest.trees_W));
    alone += fresh->locate(scan, {}, {}).status == FixStatus::Fix ? 1 : 0;
    const Fix fix = learning->locate(scan, {}, {});
    if (fix.status == FixStatus::Fix) {
      ++taught;
      EXPECT_TRUE(tests::is_right(fix.pose_W, truth)) << "query " << i;
    }
  }
  EXPECT_GT(taught, alone + 5) << alone << " alone";
}

// What a precise part of a survey teaches must not silence the sensor where the survey is less so.
TEST(Localizer, APoorPartOfASurveyIsStillFoundAfterAGoodOne) {
  Draw draw(29);
  const Forest forest = tests::make_forest(180, draw);
  Forest survey = forest;
  for (Point2& p_W : survey.trees_W) {
    p_W += p_W.x() > 0.0 ? Point2(draw.normal(0.2), draw.normal(0.2)) : Point2(0.0, 0.0);
  }
  tests::InArena<Localizer> localizer(localizer_config(SearchMethod::Fast));
  ASSERT_TRUE(localizer->set_map(survey.trees_W));
  const auto fixes_between = [&](double from_m, double to_m) {
    int fixes = 0;
    for (int i = 0; i < 60; ++i) {
      const Pose2 truth{draw.uniform(from_m, to_m), draw.uniform(-30.0, 30.0), draw.uniform(-3.0, 3.0)};
      const auto scan = tests::scan_forest(forest, truth, {.sigma_m = 0.02}, draw);
      const Fix fix = localizer->locate(tests::as_landmarks(scan), {}, {});
      fixes += fix.status == FixStatus::Fix && tests::is_right(fix.pose_W, truth) ? 1 : 0;
    }
    return fixes;
  };
  EXPECT_GE(fixes_between(-40.0, -20.0), 57);
  EXPECT_GE(fixes_between(20.0, 40.0), 50);
}

TEST_P(LocalizerBySearch, AMapThatDoesNotFitOrIsNoneIsRefused) {
  EXPECT_FALSE(localizer->set_map(std::vector<Point2>(501, Point2(1, 1))));
  EXPECT_EQ(locate({{0, 0}, {5, 1}, {3, 7}}).landmarks_in_map, 0U);
  EXPECT_FALSE(
      localizer->set_map(std::vector<Point2>{{0, 0}, {1, std::numeric_limits<double>::quiet_NaN()}, {3, 3}}));
  EXPECT_EQ(locate({{0, 0}, {5, 1}, {3, 7}}).landmarks_in_map, 0U);
  EXPECT_EQ(locate({{0, 0}, {5, 1}, {3, 7}}).status, FixStatus::NoFix);
}

}  // namespace
}  // namespace slamsensor::core
