#include "core/association/acceptance.hpp"

#include "core/association/significance.hpp"
#include "tests/support/forest.hpp"
#include "tests/unit/core/association/searched.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

// A wrong pose marked valid is the worst thing: scans of another forest must not be believed.
TEST(Acceptance, ForeignScansAreRefused) {
  int accepted = 0;
  int queries = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Draw draw(1000 + seed);
    const Forest here = tests::make_forest(180, draw);
    const Forest elsewhere = tests::make_forest(180, draw);
    AssociationConfig config;
    config.order_share = 1.0;
    Searched searched(here.trees_W, config);
    for (int i = 0; i < 100; ++i, ++queries) {
      const auto scan = tests::scan_forest(elsewhere, tests::pose_in(elsewhere, draw), {}, draw);
      const Candidates& found = searched.search(scan);
      accepted += judge(found, scan, searched.map_view(), 0.5, {}).status == FixStatus::Fix ? 1 : 0;
    }
  }
  EXPECT_EQ(accepted, 0) << "of " << queries;
}

TEST(Acceptance, TrueScansAreAcceptedWithTheirPose) {
  Draw draw(2000);
  const Forest forest = tests::make_forest(180, draw);
  Searched searched(forest.trees_W, {});
  int accepted = 0;
  for (int i = 0; i < 50; ++i) {
    const Pose2 truth = tests::pose_in(forest, draw);
    const auto scan = tests::scan_forest(forest, truth, {}, draw);
    const Candidates& found = searched.search(scan);
    const Verdict verdict = judge(found, scan, searched.map_view(), 0.5, {});
    if (verdict.status == FixStatus::Fix) {
      ++accepted;
      EXPECT_TRUE(tests::is_right(found.list[0].pose_W, truth)) << "query " << i;
    }
  }
  EXPECT_GE(accepted, 45);
}

TEST(Acceptance, TwoCopiesOfAPlaceAreAmbiguous) {
  Draw draw(15);
  Forest forest = tests::make_forest(30, draw);
  const Forest one = forest;
  for (const Point2& p : one.trees_W) {
    forest.trees_W.push_back(p + Point2(200.0, 30.0));
  }
  AssociationConfig config;
  config.order_share = 1.0;
  Searched searched(forest.trees_W, config);
  const auto scan = tests::scan_forest(one, {0, 0, 0.4}, {}, draw);
  const Candidates& found = searched.search(scan);
  const Verdict verdict = judge(found, scan, searched.map_view(), 0.5, {});
  EXPECT_EQ(verdict.status, FixStatus::Ambiguous);
  EXPECT_EQ(verdict.reason, FixReason::Symmetric);
  AcceptanceConfig paper;
  paper.rule = AcceptanceRule::Paper;
  EXPECT_EQ(judge(found, scan, searched.map_view(), 0.5, paper).status, FixStatus::Fix);
}

// A plantation looks the same one row on.
TEST(Acceptance, RowsAreAmbiguous) {
  Draw draw(16);
  std::vector<Point2> rows;
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 20; ++y) {
      rows.push_back(Point2{4.0 * x + draw.normal(0.05), 3.0 * y + draw.normal(0.05)});
    }
  }
  AssociationConfig config;
  config.order_share = 1.0;
  Searched searched(rows, config);
  const Forest plantation{rows, 0.0};
  const auto scan = tests::scan_forest(plantation, {40.0, 30.0, 0.2}, {}, draw);
  EXPECT_EQ(judge(searched.search(scan), scan, searched.map_view(), 0.5, {}).status, FixStatus::Ambiguous);
}

TEST(Acceptance, ChanceOfAMatchIsTheDensityTimesTheDisc) {
  Draw draw(17);
  const Forest forest = tests::make_forest(1000, draw);
  Searched searched(forest.trees_W, {});
  std::vector<Point2> anywhere;
  for (int i = 0; i < 60; ++i) {
    anywhere.push_back(Point2{draw.uniform(-100, 100), draw.uniform(-100, 100)});
  }
  const double expected = 3.14159 * 0.25 / 70.0;
  EXPECT_NEAR(chance_match({}, anywhere, searched.map_view(), 0.5), expected, 0.15 * expected);
  EXPECT_EQ(chance_match({1e4, 0, 0}, anywhere, searched.map_view(), 0.5), 0.0);
  EXPECT_EQ(chance_match({}, {}, searched.map_view(), 0.5), 0.0);
}

}  // namespace
}  // namespace slamsensor::core
