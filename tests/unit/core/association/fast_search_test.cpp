// The fast search against the paper's, which goes through all triangles of the correspondence graph.
#include "core/association/fast_search.hpp"

#include "core/association/graph_search.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

Capacities capacities_of(std::size_t landmarks) {
  Capacities c;
  c.scan_landmarks = 64;
  c.map_landmarks = static_cast<std::uint32_t>(landmarks);
  c.map_edges = 14 * c.map_landmarks + 100;
  return c;
}

AssociationConfig exhaustive() {
  AssociationConfig config;
  config.order_share = 1.0;
  return config;
}

/// A map that both searches look through.
class Searches {
 public:
  explicit Searches(std::vector<Point2> map_W, const AssociationConfig& config = exhaustive())
      : map_W_(std::move(map_W)),
        slots_(map_W_.size()),
        index_(config, capacities_of(map_W_.size())),
        fast_(config, capacities_of(map_W_.size())),
        graph_(config, capacities_of(map_W_.size())) {
    std::iota(slots_.begin(), slots_.end(), 0U);
    for (const std::uint32_t slot : slots_) {
      index_->insert(slot, 0, map_W_[slot]);
    }
  }
  const Candidates& fast(const std::vector<Point2>& scan, const Deadline& deadline = {},
                         MapSlot except = kNoMap) {
    fast_->search(scan, *index_, map_W_, except, {}, deadline, *fast_found_);
    return *fast_found_;
  }
  const Candidates& paper(const std::vector<Point2>& scan) {
    paper_found_->list.clear();
    graph_->search(scan, 0, slots_, map_W_, {}, *paper_found_);
    return *paper_found_;
  }

 private:
  std::vector<Point2> map_W_;
  std::vector<std::uint32_t> slots_;
  tests::InArena<LandmarkIndex> index_;
  tests::InArena<FastSearch> fast_;
  tests::InArena<GraphSearch> graph_;
  std::unique_ptr<Candidates> fast_found_ = std::make_unique<Candidates>();
  std::unique_ptr<Candidates> paper_found_ = std::make_unique<Candidates>();
};

bool is_same(const Pose2& a, const Pose2& b) {
  const Pose2 error = a.inverse() * b;
  return error.translation().norm() <= 0.3 && std::abs(error.heading_rad) <= std::numbers::pi / 180.0;
}

Forest make_rows(std::uint32_t count, Draw& draw) {
  const auto columns = static_cast<std::uint32_t>(std::sqrt(count));
  Forest forest;
  forest.side_m = 5.0 * columns;
  for (std::uint32_t i = 0; i < columns * columns; ++i) {
    forest.trees_W.push_back({5.0 * (i % columns) - 0.5 * forest.side_m + draw.normal(0.4),
                              5.0 * (i / columns) - 0.5 * forest.side_m + draw.normal(0.4)});
  }
  return forest;
}

Forest make_clusters(std::uint32_t count, Draw& draw) {
  Forest forest;
  forest.side_m = std::sqrt(70.0 * count);
  while (forest.trees_W.size() < count) {
    const Point2 middle{draw.uniform(-0.5, 0.5) * forest.side_m, draw.uniform(-0.5, 0.5) * forest.side_m};
    for (int i = 0; i < 8 && forest.trees_W.size() < count; ++i) {
      forest.trees_W.push_back(middle + Point2{draw.normal(4.0), draw.normal(4.0)});
    }
  }
  return forest;
}

struct Tally {
  int queries = 0;
  int kept = 0;
};

using MakeForest = Forest (*)(std::uint32_t count, Draw& draw);

/// How often the fast search has what the paper's search ranks first, where that has at least 6 matches.
Tally compare(MakeForest make, std::uint64_t seeds, const tests::ScanModel& model) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Draw draw(4000 + seed);
    const Forest forest = make(60 + draw.below(341), draw);
    Searches searches(forest.trees_W);
    for (int query = 0; query < 4; ++query) {
      const auto scan = tests::scan_forest(forest, tests::pose_in(forest, draw), model, draw);
      const Candidates& paper = searches.paper(scan);
      if (paper.list.empty() || paper.list[0].matches.size() < 6) {
        continue;
      }
      ++tally.queries;
      const Candidates& fast = searches.fast(scan);
      tally.kept += std::any_of(fast.list.begin(), fast.list.end(),
                                [&](const Candidate& candidate) {
                                  return is_same(candidate.pose_W, paper.list[0].pose_W);
                                })
                        ? 1
                        : 0;
    }
  }
  return tally;
}

// With 150 seeds it has 1,799 of 1,800 of clear scans (the one that it lacks lies in rows and is wrong) and
// 1,783 of 1,800 of poor ones, of which a third is hidden and a quarter was never mapped.
TEST(FastSearch, KeepsWhatTheExhaustiveSearchRanksFirst) {
  const struct {
    const char* name;
    MakeForest make;
  } worlds[] = {{"forest", tests::make_forest}, {"rows", make_rows}, {"clusters", make_clusters}};
  for (const auto& world : worlds) {
    const Tally clear = compare(world.make, 20, {24, 0.2, 3, 0.08});
    const Tally poor = compare(world.make, 20, {});
    EXPECT_GE(clear.queries, 75) << world.name;
    EXPECT_EQ(clear.kept, clear.queries) << world.name;
    EXPECT_GE(poor.kept, 0.98 * poor.queries) << world.name;
  }
}

struct Clock {
  int looks_left = 0;
  int looks = 0;
  static std::chrono::nanoseconds now(void* context) noexcept {
    auto& clock = *static_cast<Clock*>(context);
    ++clock.looks;
    return std::chrono::nanoseconds(clock.looks > clock.looks_left ? 1 : 0);
  }
  Deadline deadline() { return {now, this, std::chrono::nanoseconds(1)}; }
};

TEST(FastSearch, AnExpiredDeadlineAllowsNothing) {
  Draw draw(21);
  const Forest forest = tests::make_forest(200, draw);
  Searches searches(forest.trees_W);
  const auto scan = tests::scan_forest(forest, {}, {}, draw);
  Clock clock;
  const Candidates& found = searches.fast(scan, clock.deadline());
  EXPECT_EQ(found.end, SearchEnd::Deadline);
  EXPECT_TRUE(found.list.empty());
  EXPECT_EQ(found.poses_tried, 0U);
}

// Rows give more work than is done between two looks, and no clear leader that would end the search.
TEST(FastSearch, ADeadlineIsHonouredAtEachLook) {
  Draw draw(22);
  const Forest rows = make_rows(900, draw);
  AssociationConfig config = exhaustive();
  config.tolerance_m = 1.0;
  Searches searches(rows.trees_W, config);
  const Forest other = tests::make_forest(200, draw);  // nowhere in the map
  const auto scan = tests::scan_forest(other, {1, 2, 0.4}, {48, 0.3, 6, 0.3}, draw);
  Clock endless{1'000'000};
  const Candidates& whole = searches.fast(scan, endless.deadline());
  const std::uint64_t poses = whole.poses_tried;
  EXPECT_NE(whole.end, SearchEnd::Deadline);
  ASSERT_GE(endless.looks, 6);
  std::uint64_t before = 0;
  for (int looks = 1; looks < 6; ++looks) {
    Clock clock{looks};
    const Candidates& found = searches.fast(scan, clock.deadline());
    EXPECT_EQ(found.end, SearchEnd::Deadline) << looks;
    EXPECT_EQ(clock.looks, looks + 1) << "it went on after the clock had expired";
    EXPECT_GE(found.poses_tried, before);
    EXPECT_LT(found.poses_tried, poses);
    before = found.poses_tried;
  }
}

TEST(FastSearch, TheExceptedMapIsNotSearched) {
  Draw draw(23);
  const Forest forest = tests::make_forest(100, draw);
  Searches searches(forest.trees_W);
  const auto scan = tests::scan_forest(forest, {}, {}, draw);
  EXPECT_FALSE(searches.fast(scan).list.empty());
  EXPECT_TRUE(searches.fast(scan, {}, 0).list.empty());
}

TEST(FastSearch, TheSameScanGivesTheSameCandidates) {
  Draw draw(24);
  const Forest forest = tests::make_forest(200, draw);
  Searches searches(forest.trees_W);
  const auto scan = tests::scan_forest(forest, {2, 3, 0.5}, {}, draw);
  const Candidates first = searches.fast(scan);
  const Candidates& second = searches.fast(scan);
  ASSERT_EQ(first.list.size(), second.list.size());
  for (std::size_t i = 0; i < first.list.size(); ++i) {
    EXPECT_EQ(first.list[i].pose_W.x_m, second.list[i].pose_W.x_m);
    EXPECT_EQ(first.list[i].score, second.list[i].score);
  }
}

// The first search of all once planned its triangles by another window than those that came after it.
TEST(FastSearch, WhatWasSearchedBeforeDoesNotMatter) {
  Draw draw(26);
  const Forest rows = make_rows(300, draw);
  Searches fresh(rows.trees_W);
  Searches used(rows.trees_W);
  const auto scan = tests::scan_forest(rows, {2, 3, 0.5}, {}, draw);
  const auto before = tests::scan_forest(rows, {-9, 4, 2.5}, {}, draw);
  static_cast<void>(used.fast(before));
  const Candidates& a = fresh.fast(scan);
  const Candidates& b = used.fast(scan);
  EXPECT_EQ(a.poses_tried, b.poses_tried);
  EXPECT_EQ(a.vertices_searched, b.vertices_searched);
  ASSERT_EQ(a.list.size(), b.list.size());
  for (std::size_t i = 0; i < a.list.size(); ++i) {
    EXPECT_EQ(a.list[i].score, b.list[i].score);
  }
}

TEST(FastSearch, MatchesAreOneToOneAndAtMostOneCandidateLiesAtAPlace) {
  Draw draw(25);
  const Forest forest = make_rows(300, draw);
  Searches searches(forest.trees_W);
  const auto scan = tests::scan_forest(forest, {2, 3, 0.5}, {}, draw);
  const ScanMoments moments(scan);
  const Candidates& found = searches.fast(scan);
  ASSERT_FALSE(found.list.empty());
  for (std::size_t i = 0; i < found.list.size(); ++i) {
    std::vector<bool> used(forest.trees_W.size(), false);
    for (const Match& match : found.list[i].matches) {
      EXPECT_FALSE(used[match.map]);
      used[match.map] = true;
    }
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(found.list[j].score, found.list[i].score);
      EXPECT_GT(moments.displacement_m(found.list[i].pose_W, found.list[j].pose_W), 0.5);
    }
  }
}

TEST(FastSearch, ScansOfNothingAndTinyMapsGiveNothing) {
  Searches searches({{0, 0}, {4, 1}, {-3, 7}});
  EXPECT_TRUE(searches.fast({}).list.empty());
  EXPECT_TRUE(searches.fast({{0, 0}, {4, 1}}).list.empty());
  EXPECT_TRUE(searches.fast({{0, 0}, {4, 1}, {-3, 7}}).list.empty()) << "three match by construction";
}

}  // namespace
}  // namespace slamsensor::core
