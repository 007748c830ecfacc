#include "core/graph/delaunay.hpp"
#include "tests/support/graph_checks.hpp"
#include "tests/support/graph_points.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tests {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Oracle = CGAL::Delaunay_triangulation_2<Kernel>;
using PlaceEdge = std::pair<Place, Place>;

PlaceEdge ordered(const Place& a, const Place& b) {
  return a < b ? PlaceEdge{a, b} : PlaceEdge{b, a};
}

Oracle oracle_of(const Points& points) {
  std::vector<Kernel::Point_2> input;
  for (const auto& [x, y] : places_of(points)) {
    input.emplace_back(static_cast<double>(x), static_cast<double>(y));
  }
  return Oracle(input.begin(), input.end());
}

std::set<PlaceEdge> edges_of(const Oracle& oracle) {
  const auto place = [](const Oracle::Vertex_handle& vertex) {
    return Place{static_cast<std::int64_t>(vertex->point().x()),
                 static_cast<std::int64_t>(vertex->point().y())};
  };
  std::set<PlaceEdge> edges;
  for (const auto& [face, slot] : oracle.finite_edges()) {
    edges.insert(ordered(place(face->vertex(Oracle::ccw(slot))), place(face->vertex(Oracle::cw(slot)))));
  }
  return edges;
}

// The edges between different places.
std::set<PlaceEdge> edges_of(const core::Delaunay& delaunay, const Points& points) {
  const std::vector<Place> places = places_of(points);
  std::set<PlaceEdge> edges;
  for (const auto& [a, b] : delaunay.edges()) {
    if (places[a] != places[b]) {
      edges.insert(ordered(places[a], places[b]));
    }
  }
  return edges;
}

void expect_same_edges(const Points& points) {
  InArena<core::Delaunay> delaunay(static_cast<std::uint32_t>(points.size()));
  ASSERT_TRUE(delaunay->build(points));
  const Oracle oracle = oracle_of(points);
  EXPECT_EQ(edges_of(*delaunay, points), edges_of(oracle));
  EXPECT_EQ(delaunay->triangles().size(), oracle.dimension() == 2 ? oracle.number_of_faces() : 0);
}

TEST(DelaunayOracle, RandomPointsHaveTheEdgesOfCgal) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    expect_same_edges(uniform_points(10 * seed, 1000.0, seed));
  }
}

TEST(DelaunayOracle, TenThousandPointsHaveTheEdgesOfCgal) {
  expect_same_edges(uniform_points(10'000, 5000.0, 1));
  Points wide = uniform_points(10'000, 2 * core::kLatticeReach_m, 2);
  for (core::Point2& p : wide) {
    p.array() -= core::kLatticeReach_m;
  }
  expect_same_edges(wide);
}

TEST(DelaunayOracle, CollinearPointsHaveTheChainOfCgal) {
  for (const core::Point2& direction :
       {core::Point2(1.0, 0.0), core::Point2(0.0, 1.0), core::Point2(3.0, -7.0)}) {
    Points points;
    for (int i = 0; i < 200; ++i) {
      points.emplace_back((i * 37 % 101) * direction);
    }
    expect_same_edges(points);
  }
}

// Where more than three points share a circle the diagonals are free, but not their number.
TEST(DelaunayOracle, DegenerateSetsHaveTheNumbersOfCgal) {
  for (const auto& [name, points] : degenerate_sets()) {
    SCOPED_TRACE(name);
    InArena<core::Delaunay> delaunay(static_cast<std::uint32_t>(points.size()));
    ASSERT_TRUE(delaunay->build(points));
    const Oracle oracle = oracle_of(points);
    EXPECT_EQ(edges_of(*delaunay, points).size(), edges_of(oracle).size());
    EXPECT_EQ(delaunay->triangles().size(), oracle.number_of_faces());
    expect_empty_circles(places_of(points), *delaunay);
  }
}

TEST(DelaunayOracle, CrowdedLatticesHaveTheNumbersOfCgal) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Points points = uniform_points(3 + seed, 1.0, seed);
    for (core::Point2& p : points) {
      p = (p * static_cast<double>(2 + seed % 30)).array().floor() / 1024.0;
    }
    InArena<core::Delaunay> delaunay(static_cast<std::uint32_t>(points.size()));
    ASSERT_TRUE(delaunay->build(points));
    const Oracle oracle = oracle_of(points);
    EXPECT_EQ(edges_of(*delaunay, points).size(), edges_of(oracle).size());
    EXPECT_EQ(delaunay->triangles().size(), oracle.dimension() == 2 ? oracle.number_of_faces() : 0);
    expect_empty_circles(places_of(points), *delaunay);
  }
}

}  // namespace
}  // namespace slamsensor::tests
