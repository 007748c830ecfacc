#include "core/graph/delaunay.hpp"

#include "tests/support/graph_checks.hpp"
#include "tests/support/graph_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace slamsensor::tests {
namespace {

using core::Delaunay;
using core::Point2;
using testing::IsEmpty;
using testing::SizeIs;

using Edges = std::vector<Delaunay::Edge>;

Edges edges_of(const Points& points) {
  InArena<Delaunay> delaunay(static_cast<std::uint32_t>(points.size()));
  EXPECT_TRUE(delaunay->build(points));
  return {delaunay->edges().begin(), delaunay->edges().end()};
}

TEST(Delaunay, OfFewPoints) {
  EXPECT_THAT(edges_of({}), IsEmpty());
  EXPECT_THAT(edges_of({{1.0, 2.0}}), IsEmpty());
  EXPECT_EQ(edges_of({{1.0, 2.0}, {3.0, 4.0}}), (Edges{{0, 1}}));
  EXPECT_EQ(edges_of({{0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}}), (Edges{{0, 1}, {0, 2}, {1, 2}}));
}

TEST(Delaunay, TriangleIsCounterClockwiseWhicheverWayItIsGiven) {
  for (const Points& points :
       {Points{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, Points{{0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}}}) {
    InArena<Delaunay> delaunay(3U);
    ASSERT_TRUE(delaunay->build(points));
    expect_delaunay(points, *delaunay);
  }
}

TEST(Delaunay, SquareHasItsSidesAndOneDiagonal) {
  const Points points{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  InArena<Delaunay> delaunay(4U);
  ASSERT_TRUE(delaunay->build(points));
  EXPECT_THAT(delaunay->edges(), SizeIs(5));
  EXPECT_THAT(delaunay->triangles(), SizeIs(2));
  expect_delaunay(points, *delaunay);
}

TEST(Delaunay, KiteTakesTheShorterDiagonal) {
  EXPECT_EQ(edges_of({{0.0, 0.0}, {3.0, 1.0}, {6.0, 0.0}, {3.0, -1.0}}),
            (Edges{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
}

TEST(Delaunay, PointsOnALineGiveTheChainAlongIt) {
  const std::vector<double> along{4.0, -1.0, 2.0, 0.0, 3.0};  // in order: 1, 3, 2, 4, 0
  for (const Point2& direction : {Point2(1.0, 0.0), Point2(0.0, 1.0), Point2(-2.0, 1.0), Point2(5.0, 5.0)}) {
    Points points;
    for (const double t : along) {
      points.emplace_back(Point2(7.0, -3.0) + t * direction);
    }
    EXPECT_EQ(edges_of(points), (Edges{{0, 4}, {1, 3}, {2, 3}, {2, 4}})) << direction.transpose();
  }
}

TEST(Delaunay, ChainSkipsLaterPointsAtAnOccupiedPlace) {
  const Points points{{2.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}, {0.0001, 0.0}, {1.0, 0.0}};
  EXPECT_EQ(edges_of(points), (Edges{{0, 2}, {1, 2}, {1, 4}, {2, 3}, {2, 5}}));
}

TEST(Delaunay, PointsAtOnePlaceAllHangOnTheFirst) {
  EXPECT_EQ(edges_of(Points(5, Point2(12.5, 3.25))), (Edges{{0, 1}, {0, 2}, {0, 3}, {0, 4}}));
  InArena<Delaunay> delaunay(5U);
  ASSERT_TRUE(delaunay->build(Points(5, Point2(12.5, 3.25))));
  EXPECT_THAT(delaunay->triangles(), IsEmpty());
}

TEST(Delaunay, TwinsInATriangulationHangOnTheFirstWhateverTheOrderOfInsertion) {
  const Points once = uniform_points(100, 50.0, 3);
  Points points = once;
  points.insert(points.end(), once.rbegin(), once.rend());
  points.insert(points.end(), once.begin(), once.end());
  InArena<Delaunay> delaunay(300U);
  ASSERT_TRUE(delaunay->build(points));
  expect_delaunay(points, *delaunay);
}

TEST(Delaunay, OfDegenerateSetsIsExact) {
  for (const auto& [name, points] : degenerate_sets()) {
    SCOPED_TRACE(name);
    InArena<Delaunay> delaunay(static_cast<std::uint32_t>(points.size()));
    ASSERT_TRUE(delaunay->build(points));
    expect_delaunay(points, *delaunay);
  }
}

TEST(Delaunay, PythagoreanCircleHasManyPlaces) {
  EXPECT_THAT(pythagorean_circle({0.0, 0.0}),
              SizeIs(4 * 81));  // 3^4 ways for four primes of the form 4 k + 1
}

TEST(Delaunay, OfRandomPointsIsExact) {
  InArena<Delaunay> delaunay(600U);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Points points = uniform_points(30 * seed, 200.0, seed);
    ASSERT_TRUE(delaunay->build(points));
    expect_delaunay(points, *delaunay);
  }
}

// Few places, many points: cocircular, collinear and equal places at every step.
TEST(Delaunay, OfCrowdedLatticesIsExact) {
  InArena<Delaunay> delaunay(64U);
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Points points = uniform_points(4 + seed % 60, 1.0, seed);
    for (Point2& p : points) {
      p = (p * static_cast<double>(2 + seed % 7)).array().floor() / 1024.0;
    }
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_TRUE(delaunay->build(points));
    if (!delaunay->triangles().empty()) {
      expect_delaunay(points, *delaunay);
    } else {
      EXPECT_THAT(hull_of(first_at(places_of(points))), SizeIs(2 * first_at(places_of(points)).size() - 2));
      EXPECT_THAT(delaunay->edges(), SizeIs(points.size() - 1));
    }
    ASSERT_FALSE(HasFailure());
  }
}

TEST(Delaunay, IsExactUpToTheReach) {
  InArena<Delaunay> delaunay(400U);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Points points = uniform_points(196, 2 * core::kLatticeReach_m, seed);
    for (Point2& p : points) {
      p.array() -= core::kLatticeReach_m;
    }
    const double reach = core::kLatticeReach_m;
    points.insert(points.end(), {{-reach, -reach}, {reach, -reach}, {reach, reach}, {-reach, reach}});
    ASSERT_TRUE(delaunay->build(points));
    expect_delaunay(points, *delaunay);
  }
}

// Clusters 0.1 m wide and kilometres apart: long thin triangles beside tiny ones.
TEST(Delaunay, OfClustersFarApartIsExact) {
  Points points;
  for (std::uint64_t cluster = 0; cluster < 10; ++cluster) {
    for (const Point2& p : uniform_points(30, 0.1, cluster + 1)) {
      points.push_back(
          p + Point2(6000.0 * static_cast<double>(cluster * 7 % 10), 5000.0 * static_cast<double>(cluster)));
    }
  }
  InArena<Delaunay> delaunay(300U);
  ASSERT_TRUE(delaunay->build(points));
  expect_delaunay(points, *delaunay);
}

TEST(Delaunay, RefusesWhatIsNotOnTheLattice) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  InArena<Delaunay> delaunay(4U);
  const Points good{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
  for (const Point2& bad : {Point2(nan, 0.0), Point2(0.0, nan), Point2(infinity, 0.0), Point2(0.0, -infinity),
                            Point2(65'000.001, 0.0), Point2(0.0, -65'000.001), Point2(1e300, 1e300)}) {
    ASSERT_TRUE(delaunay->build(good));
    Points points = good;
    points.push_back(bad);
    EXPECT_FALSE(delaunay->build(points)) << bad.transpose();
    EXPECT_THAT(delaunay->edges(), IsEmpty());
    EXPECT_THAT(delaunay->triangles(), IsEmpty());
    EXPECT_EQ(delaunay->mesh().vertex_count(), 0U);
  }
  EXPECT_TRUE(delaunay->build(good));
}

TEST(Delaunay, RefusesMorePointsThanCapacity) {
  InArena<Delaunay> delaunay(100U);
  EXPECT_TRUE(delaunay->build(uniform_points(100, 10.0, 1)));
  EXPECT_FALSE(delaunay->build(uniform_points(101, 10.0, 1)));
  EXPECT_THAT(delaunay->edges(), IsEmpty());
  EXPECT_THAT(delaunay->triangles(), IsEmpty());
  InArena<Delaunay> none(0U);
  EXPECT_TRUE(none->build({}));
  EXPECT_FALSE(none->build(Points{{0.0, 0.0}}));
}

TEST(Delaunay, DoesNotDependOnWhatWasBuiltBefore) {
  const Points points = lattice_points(20, 20, 0.5);
  InArena<Delaunay> fresh(500U);
  InArena<Delaunay> used(500U);
  ASSERT_TRUE(used->build(uniform_points(500, 30.0, 9)));
  ASSERT_TRUE(fresh->build(points));
  ASSERT_TRUE(used->build(points));
  EXPECT_TRUE(std::ranges::equal(fresh->edges(), used->edges()));
  EXPECT_TRUE(std::ranges::equal(fresh->triangles(), used->triangles()));
}

TEST(Delaunay, MeshHoldsTheEdges) {
  InArena<Delaunay> delaunay(200U);
  ASSERT_TRUE(delaunay->build(uniform_points(200, 100.0, 4)));
  Edges from_lists;
  for (std::uint32_t v = 0; v < delaunay->mesh().vertex_count(); ++v) {
    for (const std::uint32_t u : delaunay->mesh().neighbours(v)) {
      if (v < u) {
        from_lists.push_back({v, u});
      }
    }
  }
  EXPECT_TRUE(std::ranges::equal(from_lists, delaunay->edges()));
}

}  // namespace
}  // namespace slamsensor::tests
