#include "core/geometry/convex_hull.hpp"

#include "core/detection/cell_hull.hpp"
#include "tests/unit/core/detection/detection_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace slamsensor::core {
namespace {

using detection_test::hand_config;
using detection_test::middle_rad;
using tests::InArena;

std::vector<Point2> hull_of(std::vector<Point2> points) {
  std::vector<Point2> hull(2 * points.size());
  hull.resize(convex_hull(points, hull));
  return hull;
}

double cross(const Point2& a, const Point2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

TEST(ConvexHull, SquareWithPointsInsideAndOnItsSides) {
  const std::vector<Point2> hull =
      hull_of({{1, 1}, {0, 0}, {2, 2}, {1, 0}, {0, 2}, {2, 0}, {2, 1}, {0.5, 1.5}, {0, 0}});
  ASSERT_EQ(hull.size(), 4U);
  const std::vector<Point2> expected{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(hull[i], expected[i]) << i;
  }
  EXPECT_LT((area_centroid(hull) - Point2(1, 1)).norm(), 1e-15);
}

TEST(ConvexHull, DegenerateSets) {
  EXPECT_TRUE(hull_of({}).empty());
  EXPECT_EQ(area_centroid(hull_of({})), Point2(0, 0));
  EXPECT_EQ(area_centroid(hull_of({{3, 4}})), Point2(3, 4));
  EXPECT_EQ(area_centroid(hull_of({{3, 4}, {3, 4}, {3, 4}})), Point2(3, 4));
  const std::vector<Point2> line = hull_of({{1, 1}, {3, 3}, {0, 0}, {2, 2}, {4, 4}});
  ASSERT_EQ(line.size(), 2U);
  EXPECT_EQ(area_centroid(line), Point2(2, 2));
  EXPECT_EQ(area_centroid(hull_of({{5, 1}, {5, 7}})), Point2(5, 4));  // upright
}

TEST(ConvexHull, HoldsEveryPointAndTurnsLeftOnRandomSets) {
  const unsigned seed = 99;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  for (int round = 0; round < 3000; ++round) {
    // Few values per axis, so that equal points and points in line are common.
    const auto values = 2 + random() % 12;
    std::vector<Point2> points(1 + random() % 25);
    for (Point2& p : points) {
      p = Point2(static_cast<double>(random() % values), static_cast<double>(random() % values));
    }
    const std::vector<Point2> hull = hull_of(points);
    if (hull.size() < 3) {
      continue;
    }
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Point2& a = hull[i];
      const Point2& b = hull[(i + 1) % hull.size()];
      const Point2& c = hull[(i + 2) % hull.size()];
      ASSERT_GT(cross(b - a, c - b), 0.0) << "round " << round;
      ASSERT_NE(std::count(points.begin(), points.end(), a), 0) << "round " << round;
      for (const Point2& p : points) {
        ASSERT_GE(cross(b - a, p - a), 0.0) << "round " << round;
      }
    }
  }
}

TEST(AreaCentroid, IsNotTheMeanOfTheVertices) {
  EXPECT_LT((area_centroid(std::vector<Point2>{{0, 0}, {3, 0}, {0, 3}}) - Point2(1, 1)).norm(), 1e-15);
  // A square with one side finely divided keeps its centre.
  EXPECT_LT((area_centroid(std::vector<Point2>{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {4, 4}, {0, 4}}) -
             Point2(2, 2))
                .norm(),
            1e-15);
}

TEST(AreaCentroid, KeepsItsDigitsFarAway) {
  const Point2 far(1e6, -2e6);
  const std::vector<Point2> square{far, far + Point2(0.5, 0), far + Point2(0.5, 0.5), far + Point2(0, 0.5)};
  EXPECT_LT((area_centroid(square) - far - Point2(0.25, 0.25)).norm(), 1e-9);
}

TEST(CellHull, SingleCellIsItsTrapezium) {
  const PolarGrid grid(hand_config());
  InArena<CellHull> hull(grid);
  // A trapezium between chords: parallel sides 2 r sin(9 deg) at distances r cos(9 deg) from the origin, r =
  // 7 and 8.
  const double half = 9.0 * kDegree;
  const double height = std::cos(half);
  const double from_inner = height / 3.0 * (7.0 + 2.0 * 8.0) / (7.0 + 8.0);
  const double expected_m = 7.0 * std::cos(half) + from_inner;
  for (const std::uint32_t column : {0U, 5U, 19U}) {
    const std::vector<std::uint32_t> cells{7 * 20 + column};
    const double bearing_rad = middle_rad(hand_config(), column);
    const Point2 expected = expected_m * Point2(std::cos(bearing_rad), std::sin(bearing_rad));
    EXPECT_LT((hull->centroid_L(cells) - expected).norm(), 1e-12) << column;
  }
}

TEST(CellHull, CellOfTheFirstRowIsATriangle) {
  const PolarGrid grid(hand_config());
  InArena<CellHull> hull(grid);
  const std::vector<std::uint32_t> cells{3};
  const double bearing_rad = middle_rad(hand_config(), 3);
  const double expected_m = 2.0 / 3.0 * std::cos(9.0 * kDegree);
  EXPECT_LT(
      (hull->centroid_L(cells) - expected_m * Point2(std::cos(bearing_rad), std::sin(bearing_rad))).norm(),
      1e-12);
}

TEST(CellHull, RingRoundTheOriginHasItsCentroidThere) {
  const PolarGrid grid(hand_config());
  InArena<CellHull> hull(grid);
  for (const std::uint32_t row : {0U, 7U, 99U}) {
    std::vector<std::uint32_t> cells;
    for (std::uint32_t column = 0; column < 20; ++column) {
      cells.push_back(row * 20 + column);
    }
    EXPECT_LT(hull->centroid_L(cells).norm(), 1e-12) << row;
  }
}

TEST(CellHull, CellsOfHalfATurnHaveNoAreaAndAMiddle) {
  DetectionConfig config = hand_config();
  config.bearing_step_rad = 180.0 * kDegree;
  const PolarGrid grid(config);
  InArena<CellHull> hull(grid);
  EXPECT_LT(hull->centroid_L(std::vector<std::uint32_t>{2}).norm(), 1e-12);
  config.bearing_step_rad = 360.0 * kDegree;
  const PolarGrid one(config);
  InArena<CellHull> ray(one);
  EXPECT_LT((ray->centroid_L(std::vector<std::uint32_t>{2}) - Point2(2.5, 0)).norm(), 1e-12);
}

/// The hull of all corners of all cells, without leaving any out.
Point2 centroid_of_all_corners(const PolarGrid& grid, const std::vector<std::uint32_t>& cells) {
  std::vector<Point2> corners;
  for (const std::uint32_t cell : cells) {
    const std::uint32_t row = cell / grid.columns();
    const std::uint32_t column = cell % grid.columns();
    for (const std::uint32_t r : {row, row + 1}) {
      for (const std::uint32_t edge : {column, grid.next(column)}) {
        corners.emplace_back(grid.radius_m(r) * std::cos(grid.edge_rad(edge)),
                             grid.radius_m(r) * std::sin(grid.edge_rad(edge)));
      }
    }
  }
  return area_centroid(hull_of(corners));
}

TEST(CellHull, EqualsTheHullOfAllCornersOnRandomGroups) {
  const unsigned seed = 2718;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  DetectionConfig config = hand_config();
  for (const double step_deg : {18.0, 7.0, 1.3}) {
    config.bearing_step_rad = step_deg * kDegree;
    const PolarGrid grid(config);
    InArena<CellHull> hull(grid);
    for (int round = 0; round < 500; ++round) {
      std::vector<std::uint32_t> cells;
      const auto first = random();
      for (std::size_t i = 1 + random() % 40; i > 0; --i) {
        const auto column = static_cast<std::uint32_t>((first + random() % 6) % grid.columns());
        cells.push_back(static_cast<std::uint32_t>(random() % 9) * grid.columns() + column);
      }
      const Point2 expected = centroid_of_all_corners(grid, cells);
      ASSERT_LT((hull->centroid_L(cells) - expected).norm(), 1e-9)
          << "round " << round << " step " << step_deg;
    }
  }
}

}  // namespace
}  // namespace slamsensor::core
