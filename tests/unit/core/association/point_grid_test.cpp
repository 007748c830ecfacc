#include "core/association/point_grid.hpp"

#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;

void expect_like_brute_force(const PointGrid& grid, const std::vector<Point2>& points, const Point2& q,
                             double radius) {
  std::uint32_t nearest = PointGrid::kNone;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const double distance2 = (points[i] - q).squaredNorm();
    if (distance2 <= radius * radius) {
      ++count;
      if (nearest == PointGrid::kNone || distance2 < (points[nearest] - q).squaredNorm()) {
        nearest = i;
      }
    }
  }
  EXPECT_EQ(grid.nearest_within(q, radius), nearest);
  EXPECT_EQ(grid.count_within(q, radius), count);
}

TEST(PointGrid, FindsWhatBruteForceFinds) {
  Draw draw(11);
  tests::InArena<PointGrid> grid("grid", 500U);
  for (int round = 0; round < 60; ++round) {
    const double width = draw.uniform(0.0, 300.0);
    const double height = round % 3 == 0 ? 0.0 : draw.uniform(0.0, 300.0);
    std::vector<Point2> points;
    for (std::uint32_t i = draw.below(500); i > 0; --i) {
      points.push_back(Point2{draw.uniform(0, width), draw.uniform(0, height)});
    }
    grid->build(points, draw.uniform(0.1, 5.0));
    for (int i = 0; i < 30; ++i) {
      const Point2 q{draw.uniform(-20, width + 20), draw.uniform(-20, height + 20)};
      expect_like_brute_force(*grid, points, q, draw.uniform(0.0, 30.0));
    }
  }
}

TEST(PointGrid, IsEmptyBeforeAndAfterAnEmptyBuild) {
  tests::InArena<PointGrid> grid("grid", 10U);
  EXPECT_EQ(grid->nearest_within({0, 0}, 1e6), PointGrid::kNone);
  grid->build({}, 1.0);
  EXPECT_EQ(grid->count_within({0, 0}, 1e6), 0U);
}

TEST(PointGrid, HoldsCoincidentPointsAndFarQueries) {
  tests::InArena<PointGrid> grid("grid", 8U);
  const std::vector<Point2> points(8, Point2(3, 3));
  grid->build(points, 1.0);
  EXPECT_EQ(grid->count_within({3, 3}, 0.0), 8U);
  EXPECT_EQ(grid->nearest_within({3, 3.5}, 1.0), 0U);
  EXPECT_EQ(grid->nearest_within({1e300, -1e300}, 1.0), PointGrid::kNone);
}

TEST(PointGrid, CopyAnswersLikeTheOriginal) {
  Draw draw(12);
  tests::InArena<PointGrid> a("grid", 100U);
  tests::InArena<PointGrid> b("grid", 100U);
  std::vector<Point2> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back(Point2{draw.uniform(0, 50), draw.uniform(0, 50)});
  }
  a->build(points, 1.0);
  const std::vector<Point2> twin = points;
  b->copy_from(*a, twin);
  for (int i = 0; i < 50; ++i) {
    expect_like_brute_force(*b, twin, {draw.uniform(0, 50), draw.uniform(0, 50)}, 5.0);
  }
}

}  // namespace
}  // namespace slamsensor::core
