#include "core/association/paper_search.hpp"

#include "core/association/triangulation.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"
#include "tests/unit/core/association/searched.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

TEST(PaperSearch, FindsTheScanInAForest) {
  for (const std::uint32_t count : {60U, 180U, 1000U}) {
    int right = 0;
    constexpr int kQueries = 20;
    Draw draw(100 + count);
    const Forest forest = tests::make_forest(count, draw);
    Searched searched(forest.trees_W, {});
    for (int i = 0; i < kQueries; ++i) {
      const Pose2 truth = tests::pose_in(forest, draw);
      const Candidates& found = searched.search(tests::scan_forest(forest, truth, {}, draw));
      right += !found.list.empty() && tests::is_right(found.list[0].pose_W, truth) ? 1 : 0;
    }
    EXPECT_GE(right, kQueries - 1) << count << " trees";
  }
}

/// The best match count over all triples of all pairs, by brute force: the search may not miss what it would
/// rank first.
std::size_t best_by_brute_force(const std::vector<Point2>& scan, const MapView& map,
                                const AssociationConfig& config) {
  tests::InArena<PoseScorer> scorer(config, static_cast<std::uint32_t>(map.positions_W.size()));
  const auto k = static_cast<std::uint32_t>(scan.size());
  const auto n = static_cast<std::uint32_t>(map.positions_W.size());
  std::size_t best = 0;
  for (std::uint32_t i = 0; i < k; ++i) {
    for (std::uint32_t j = i + 1; j < k; ++j) {
      for (std::uint32_t l = j + 1; l < k; ++l) {
        for (std::uint32_t a = 0; a < n; ++a) {
          for (std::uint32_t b = 0; b < n; ++b) {
            if (std::abs((scan[i] - scan[j]).norm() - (map.positions_W[a] - map.positions_W[b]).norm()) >
                config.tolerance_m) {
              continue;
            }
            for (std::uint32_t c = 0; c < n; ++c) {
              for (const Pose2& pose : triangulate(
                       {scan[i], scan[j], scan[l]},
                       {map.positions_W[a], map.positions_W[b], map.positions_W[c]}, config.tolerance_m)) {
                const auto candidate = scorer->refine(pose, scan, map);
                best = std::max(best, candidate ? candidate->matches.size() : 0);
              }
            }
          }
        }
      }
    }
  }
  return best;
}

TEST(PaperSearch, ExhaustiveSearchFindsWhatBruteForceRanksFirst) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(16, draw);
    AssociationConfig config;
    config.order_share = 1.0;
    config.depth = 16;  // complete graphs: every triple is a triangle
    Searched searched(forest.trees_W, config);
    const auto scan = tests::scan_forest(forest, {1.0, -2.0, 0.7}, {10, 0.2, 1, 0.1}, draw);
    const Candidates& found = searched.search(scan);
    ASSERT_FALSE(found.list.empty());
    std::size_t most = 0;
    for (const Candidate& candidate : found.list) {
      most = std::max(most, candidate.matches.size());
    }
    EXPECT_EQ(most, best_by_brute_force(scan, searched.map_view(), config)) << "seed " << seed;
    EXPECT_EQ(found.end, SearchEnd::Complete);
  }
}

TEST(PaperSearch, MatchesAreOneToOneWithinTheToleranceAndInOrder) {
  Draw draw(9);
  const Forest forest = tests::make_forest(180, draw);
  Searched searched(forest.trees_W, {});
  const auto scan = tests::scan_forest(forest, {0, 0, 1}, {}, draw);
  for (const Candidate& candidate : searched.search(scan, 3).list) {
    std::vector<bool> used(forest.trees_W.size(), false);
    double residual = 0.0;
    for (std::size_t i = 0; i < candidate.matches.size(); ++i) {
      const Match& m = candidate.matches[i];
      EXPECT_TRUE(i == 0 || candidate.matches[i - 1].scan < m.scan);
      EXPECT_FALSE(used[m.map]);
      used[m.map] = true;
      const double distance = (candidate.pose_W * scan[m.scan] - forest.trees_W[m.map]).norm();
      EXPECT_LE(distance, 0.5 + 1e-6);
      residual += distance * distance;
    }
    EXPECT_NEAR(candidate.residual_m2, residual, 1e-3);
  }
}

TEST(PaperSearch, CandidatesAreRankedAndFewAtOnePlace) {
  Draw draw(10);
  const Forest forest = tests::make_forest(180, draw);
  Searched searched(forest.trees_W, {});
  const auto scan = tests::scan_forest(forest, {3, 2, -1}, {}, draw);
  const ScanMoments moments(scan);
  const Candidates& found = searched.search(scan, 2);
  for (std::size_t i = 0; i < found.list.size(); ++i) {
    int here = 0;
    for (std::size_t j = 0; j < found.list.size(); ++j) {
      here += moments.displacement_m(found.list[i].pose_W, found.list[j].pose_W) <= 0.5 ? 1 : 0;
    }
    EXPECT_LE(here, 2);
    EXPECT_TRUE(i == 0 || !found.list[i].more_significant_than(found.list[i - 1]));
  }
}

TEST(PaperSearch, SharesOfTheOrderAddUp) {
  Draw draw(11);
  const Forest forest = tests::make_forest(180, draw);
  AssociationConfig eighth;
  AssociationConfig all;
  all.order_share = 1.0;
  Searched stepwise(forest.trees_W, eighth);
  Searched at_once(forest.trees_W, all);
  const auto scan = tests::scan_forest(forest, {3, 2, -1}, {}, draw);
  const Candidates first = stepwise.search(scan);
  EXPECT_EQ(first.end, SearchEnd::Share);
  EXPECT_EQ(first.vertices_searched, (first.vertices_total + 7) / 8);
  const Candidates& rest = stepwise.rest();
  const Candidates& whole = at_once.search(scan);
  EXPECT_EQ(rest.end, SearchEnd::Complete);
  EXPECT_EQ(rest.poses_tried, whole.poses_tried);
  EXPECT_EQ(rest.list[0].matches.size(), whole.list[0].matches.size());
  EXPECT_LT(first.poses_tried, whole.poses_tried);
}

TEST(PaperSearch, StopsAtTheDeadline) {
  Draw draw(12);
  const Forest forest = tests::make_forest(180, draw);
  Searched searched(forest.trees_W, {});
  int looks = 0;
  const Deadline deadline{
      [](void* context) noexcept { return std::chrono::nanoseconds(++*static_cast<int*>(context)); }, &looks,
      std::chrono::nanoseconds(3)};
  const auto scan = tests::scan_forest(forest, {3, 2, -1}, {}, draw);
  const Candidates& found = searched.search(scan, 1, deadline);
  EXPECT_EQ(found.end, SearchEnd::Deadline);
  EXPECT_EQ(looks, 3);  // it does not go on after the look that said so
  EXPECT_LT(found.vertices_searched, (found.vertices_total + 7) / 8);
}

// Rows of a plantation, close together: one vertex alone has hundreds of thousands of pairs of neighbours.
TEST(PaperSearch, LooksAtTheDeadlineWithinAVertex) {
  std::vector<Point2> lattice;
  for (int i = 0; i < 64; ++i) {
    lattice.emplace_back(1.5 * (i % 8), 1.5 * (i / 8));
  }
  AssociationConfig config;
  config.depth = 4;
  config.tolerance_m = 1.0;
  Searched searched(lattice, config);
  int looks = 0;
  const Deadline deadline{
      [](void* context) noexcept { return std::chrono::nanoseconds(++*static_cast<int*>(context)); }, &looks,
      std::chrono::nanoseconds(5)};
  const Candidates& found = searched.search(lattice, 1, deadline);
  EXPECT_EQ(found.end, SearchEnd::Deadline);
  EXPECT_EQ(looks, 5);
  EXPECT_EQ(found.vertices_searched, 0U);  // it is still at its first vertex
  EXPECT_LE(found.poses_tried, 5U * 4096U / 256U);
}

TEST(PaperSearch, IgnoresTheMirrorImage) {
  Draw draw(13);
  const Forest forest = tests::make_forest(60, draw);
  std::vector<Point2> mirrored = tests::scan_forest(forest, {0, 0, 0}, {20, 0.0, 0, 0.0}, draw);
  for (Point2& p : mirrored) {
    p.y() = -p.y();
  }
  Searched searched(forest.trees_W, {});
  const Candidates& found = searched.search(mirrored);
  EXPECT_TRUE(found.list.empty() || found.list[0].matches.size() < 9) << found.list[0].matches.size();
}

TEST(PaperSearch, TinyAndDegenerateInputsFindNothing) {
  Draw draw(14);
  const Forest forest = tests::make_forest(30, draw);
  Searched searched(forest.trees_W, {});
  EXPECT_TRUE(searched.search({}).list.empty());
  EXPECT_TRUE(searched.search({Point2(1, 1)}).list.empty());
  EXPECT_TRUE(searched.search({Point2(1, 1), Point2(1, 1), Point2(1, 1)}).list.empty());
  Searched empty_map(std::vector<Point2>{Point2(0, 0)}, {});
  EXPECT_TRUE(empty_map.search({Point2(1, 1), Point2(2, 5), Point2(7, 3), Point2(4, 4)}).list.empty());
}

}  // namespace
}  // namespace slamsensor::core
