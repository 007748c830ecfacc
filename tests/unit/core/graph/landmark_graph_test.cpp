#include "core/graph/landmark_graph.hpp"

#include "tests/support/graph_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

namespace slamsensor::tests {
namespace {

using core::Delaunay;
using core::LandmarkGraph;
using core::Point2;

struct ListedEdge {
  std::uint32_t steps;
  float length_m;
  std::uint32_t a;
  std::uint32_t b;

  auto operator<=>(const ListedEdge&) const = default;
};

float length_of(const Points& points, std::uint32_t a, std::uint32_t b) {
  return static_cast<float>((points[a] - points[b]).norm());
}

// All pairs at most `depth` mesh steps apart, by (steps, length, a, b), from the table of all shortest ways
// (Floyd's algorithm on the edges of the mesh: nothing in common with a breadth-first search).
std::vector<ListedEdge> expected_edges(const Points& points, std::uint32_t depth) {
  const auto n = static_cast<std::uint32_t>(points.size());
  InArena<Delaunay> delaunay(n);
  EXPECT_TRUE(delaunay->build(points));
  constexpr std::uint32_t kFar = 1'000'000;
  std::vector<std::vector<std::uint32_t>> steps(n, std::vector<std::uint32_t>(n, kFar));
  for (const auto& edge : delaunay->edges()) {
    steps[edge.a][edge.b] = steps[edge.b][edge.a] = 1;
  }
  for (std::uint32_t via = 0; via < n; ++via) {
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = 0; j < n; ++j) {
        steps[i][j] = std::min(steps[i][j], steps[i][via] + steps[via][j]);
      }
    }
  }
  std::vector<ListedEdge> edges;
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = a + 1; b < n; ++b) {
      if (steps[a][b] <= depth) {
        edges.push_back({steps[a][b], length_of(points, a, b), a, b});
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// The edges of a graph by their ends; fails unless it is symmetric, its lists are sorted and its lengths are
// right.
std::vector<std::pair<std::uint32_t, std::uint32_t>> checked_edges(const LandmarkGraph& graph,
                                                                   const Points& points) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> seen;
  for (std::uint32_t v = 0; v < graph.vertex_count(); ++v) {
    std::pair<float, std::uint32_t> before{-1.0F, 0};
    for (const auto& [u, length_m] : graph.neighbours(v)) {
      EXPECT_NE(u, v);
      EXPECT_EQ(length_m, length_of(points, u, v));
      EXPECT_LT(before, std::pair(length_m, u)) << "list of " << v << " is not sorted";
      before = {length_m, u};
      ++seen[{std::min(u, v), std::max(u, v)}];
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& [edge, times] : seen) {
    EXPECT_EQ(times, 2) << "edge " << edge.first << ' ' << edge.second << " is not in both lists";
    edges.push_back(edge);
  }
  EXPECT_EQ(graph.edge_count(), edges.size());
  return edges;
}

// Fails unless the graph holds exactly the first `capacity` of the expected edges and counts the others as
// dropped.
void expect_graph(const Points& points, std::uint32_t depth, std::uint32_t capacity) {
  SCOPED_TRACE(testing::Message() << points.size() << " points, depth " << depth << ", capacity "
                                  << capacity);
  const auto n = static_cast<std::uint32_t>(points.size());
  const std::vector<ListedEdge> all = expected_edges(points, depth);
  InArena<Delaunay> delaunay(n);
  InArena<LandmarkGraph> graph("graph", n, capacity);
  ASSERT_TRUE(graph->build(points, *delaunay, depth));
  ASSERT_EQ(graph->vertex_count(), n);
  const std::size_t kept = std::min<std::size_t>(capacity, all.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (std::size_t i = 0; i < kept; ++i) {
    expected.emplace_back(all[i].a, all[i].b);
  }
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(checked_edges(*graph, points), expected);
  EXPECT_EQ(graph->edges_dropped(), all.size() - kept);
}

TEST(LandmarkGraph, JoinsWhatIsWithinDepth) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (const std::uint32_t depth : {0U, 1U, 2U, 3U, 7U}) {
      expect_graph(uniform_points(120, 100.0, seed), depth, 8000);
    }
  }
  expect_graph(lattice_points(9, 9, 1.0), 2, 4000);
  expect_graph(lattice_points(30, 1, 1.0), 2, 4000);
  expect_graph(Points(20, Point2(3.0, 4.0)), 2, 4000);
  expect_graph({}, 2, 10);
  expect_graph({{1.0, 1.0}}, 2, 10);
}

// Every capacity from none to more than enough: within the second step, within the first, at the border of
// both.
TEST(LandmarkGraph, KeepsTheShortestOfTheFirstStepsWhenFull) {
  const Points points = uniform_points(40, 100.0, 6);
  const auto all = static_cast<std::uint32_t>(expected_edges(points, 3).size());
  for (std::uint32_t capacity = 0; capacity <= all + 1; ++capacity) {
    expect_graph(points, 3, capacity);
    ASSERT_FALSE(HasFailure());
  }
}

// On a lattice many edges have one length: the ends decide, and the graph stays symmetric.
TEST(LandmarkGraph, BreaksTiesOfLengthByTheEnds) {
  const Points points = lattice_points(8, 8, 1.0);
  const auto all = static_cast<std::uint32_t>(expected_edges(points, 2).size());
  for (std::uint32_t capacity = 0; capacity <= all; capacity += 7) {
    expect_graph(points, 2, capacity);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(LandmarkGraph, LongListsAreSorted) {
  expect_graph(uniform_points(200, 100.0, 8), 50, 19'900);  // complete: 199 neighbours each
}

TEST(LandmarkGraph, IsEmptyWhenRefused) {
  InArena<Delaunay> delaunay(20U);
  InArena<LandmarkGraph> graph("graph", 10U, 100U);
  ASSERT_TRUE(graph->build(uniform_points(10, 10.0, 1), *delaunay, 2));
  EXPECT_GT(graph->edge_count(), 0U);
  EXPECT_FALSE(graph->build(uniform_points(11, 10.0, 1), *delaunay, 2)) << "more than the graph takes";
  EXPECT_EQ(graph->vertex_count(), 0U);
  EXPECT_EQ(graph->edge_count(), 0U);
  EXPECT_EQ(graph->edges_dropped(), 0U);
  const Points bad{{0.0, 0.0}, {std::numeric_limits<double>::quiet_NaN(), 0.0}};
  EXPECT_FALSE(graph->build(bad, *delaunay, 2));
  EXPECT_EQ(graph->vertex_count(), 0U);
  EXPECT_TRUE(graph->build(uniform_points(10, 10.0, 1), *delaunay, 2));
}

TEST(LandmarkGraph, OneDelaunayServesSeveralGraphs) {
  const Points first = uniform_points(100, 50.0, 1);
  const Points second = uniform_points(60, 50.0, 2);
  InArena<Delaunay> delaunay(100U);
  InArena<LandmarkGraph> a("a", 100U, 2000U);
  InArena<LandmarkGraph> b("b", 100U, 2000U);
  ASSERT_TRUE(a->build(first, *delaunay, 2));
  const auto before = checked_edges(*a, first);
  ASSERT_TRUE(b->build(second, *delaunay, 2));
  EXPECT_EQ(checked_edges(*a, first), before);
  EXPECT_EQ(checked_edges(*b, second).size(), expected_edges(second, 2).size());
}

TEST(LandmarkGraph, CopyIsEqual) {
  const Points points = uniform_points(100, 50.0, 1);
  InArena<Delaunay> delaunay(100U);
  InArena<LandmarkGraph> graph("graph", 100U, 500U);
  InArena<LandmarkGraph> copy("copy", 100U, 500U);
  ASSERT_TRUE(graph->build(points, *delaunay, 2));
  ASSERT_GT(graph->edges_dropped(), 0U);
  copy->copy_from(*graph);
  EXPECT_EQ(copy->vertex_count(), 100U);
  EXPECT_EQ(copy->edges_dropped(), graph->edges_dropped());
  EXPECT_EQ(checked_edges(*copy, points), checked_edges(*graph, points));
}

// The paper's Fig. 5: the graph of 1000 uniform random points in a square grows from the mesh alone to nearly
// complete.
TEST(LandmarkGraph, GrowsWithDepthLikeThePapersFigure5) {
  constexpr std::uint32_t kPoints = 1000;
  constexpr std::uint32_t kComplete = kPoints * (kPoints - 1) / 2;
  constexpr std::uint64_t kSeeds = 20;
  InArena<Delaunay> delaunay(kPoints);
  InArena<LandmarkGraph> graph("graph", kPoints, kComplete);
  double mean_edges = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    ASSERT_TRUE(graph->build(uniform_points(kPoints, 1000.0, seed), *delaunay, 2));
    mean_edges += static_cast<double>(graph->edge_count()) / kSeeds;
  }
  EXPECT_NEAR(mean_edges, 9784.0, 97.84) << "depth 2, seeds 1 to " << kSeeds;

  const Points points = uniform_points(kPoints, 1000.0, 1);
  std::uint32_t before = 0;
  for (std::uint32_t depth = 1; depth <= 20; ++depth) {
    ASSERT_TRUE(graph->build(points, *delaunay, depth));
    EXPECT_GE(graph->edge_count(), before);
    before = graph->edge_count();
    RecordProperty("edges_at_depth_" + std::to_string(depth), std::to_string(before));
  }
  EXPECT_GT(before, kComplete - kComplete / 100);
  EXPECT_LE(before, kComplete);
}

}  // namespace
}  // namespace slamsensor::tests
