#include "core/association/triangulation.hpp"

#include "tests/support/forest.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::core {
namespace {

using tests::Draw;

std::array<Point2, 3> seen_from(const Pose2& pose_W, const std::array<Point2, 3>& map_W) {
  std::array<Point2, 3> scan;
  for (std::size_t i = 0; i < 3; ++i) {
    scan[i] = pose_W.inverse() * map_W[i];
  }
  return scan;
}

double error_m(const Pose2& a, const Pose2& b) {
  return (a.translation() - b.translation()).norm();
}

TEST(Triangulation, RecoversThePoseFromExactDistances) {
  Draw draw(1);
  int with_pose = 0;
  for (int i = 0; i < 1000; ++i) {
    const Pose2 truth{draw.uniform(-50, 50), draw.uniform(-50, 50), draw.uniform(-3.14, 3.14)};
    std::array<Point2, 3> map;
    for (Point2& p : map) {
      p = Point2{draw.uniform(-50, 50), draw.uniform(-50, 50)};
    }
    double best = 1e9;
    for (const Pose2& pose : triangulate(seen_from(truth, map), map, 0.01)) {
      best =
          std::min(best, error_m(pose, truth) + std::abs(wrap_angle(pose.heading_rad - truth.heading_rad)));
    }
    if (best < 1e9) {
      ++with_pose;
      EXPECT_LT(best, 1e-6) << "case " << i;
    }
  }
  EXPECT_GT(with_pose, 950);  // the rest stand in line with their landmarks
}

TEST(Triangulation, CollinearLandmarksYieldBothConjugates) {
  const std::array<Point2, 3> map{Point2(-10, 5), Point2(0, 5), Point2(12, 5)};
  const Pose2 truth{1.0, 0.0, 0.3};
  const PoseCandidates poses = triangulate(seen_from(truth, map), map, 0.1);
  ASSERT_EQ(poses.size(), 2U);
  const bool first = error_m(poses[0], truth) < 1e-9;
  const Pose2& found = first ? poses[0] : poses[1];
  const Pose2& mirrored = first ? poses[1] : poses[0];
  EXPECT_LT(error_m(found, truth), 1e-9);
  EXPECT_NEAR(found.heading_rad, 0.3, 1e-9);
  EXPECT_NEAR(mirrored.x_m, 1.0, 1e-9);
  EXPECT_NEAR(mirrored.y_m, 10.0, 1e-9);
}

TEST(Triangulation, RefusesLandmarksInLineWithTheSensor) {
  const std::array<Point2, 3> map{Point2(5, 0), Point2(10, 0.1), Point2(20, -0.1)};
  EXPECT_TRUE(triangulate(seen_from(Pose2{}, map), map, 0.5).empty());
}

TEST(Triangulation, RefusesCirclesThatMissEachOther) {
  const std::array<Point2, 3> map{Point2(0, 0), Point2(30, 0), Point2(0, 30)};
  const std::array<Point2, 3> scan{Point2(5, 0), Point2(0, 5), Point2(-5, 0)};
  EXPECT_TRUE(triangulate(scan, map, 0.5).empty());
}

TEST(Triangulation, CirclesThatMissWithinTheToleranceTouch) {
  // Two landmarks on either side of the sensor, each measured 5 cm short.
  const std::array<Point2, 3> map{Point2(-10, 0), Point2(10, 0), Point2(0, 10)};
  const std::array<Point2, 3> scan{Point2(-9.95, 0.0), Point2(9.95, 0.0), Point2(0, 10)};
  double best = 1e9;
  for (const Pose2& pose : triangulate(scan, map, 0.5)) {
    best = std::min(best, error_m(pose, Pose2{}));
  }
  EXPECT_LT(best, 1.1);
}

TEST(Triangulation, NoiseWithinTheToleranceStaysWithinItsGeometry) {
  Draw draw(7);
  for (int i = 0; i < 200; ++i) {
    const Pose2 truth{draw.uniform(-5, 5), draw.uniform(-5, 5), draw.uniform(-3, 3)};
    const std::array<Point2, 3> map{Point2(20, 0), Point2(-10, 17), Point2(-10, -17)};
    auto scan = seen_from(truth, map);
    for (Point2& p : scan) {
      p += Point2{draw.normal(0.05), draw.normal(0.05)};
    }
    double best = 1e9;
    for (const Pose2& pose : triangulate(scan, map, 0.5)) {
      best = std::min(best, error_m(pose, truth));
    }
    EXPECT_LT(best, 0.5) << "case " << i;
  }
}

TEST(Triangulation, CoincidentMapLandmarksGiveNothing) {
  const std::array<Point2, 3> map{Point2(5, 5), Point2(5, 5), Point2(5, 5)};
  const std::array<Point2, 3> scan{Point2(3, 0), Point2(0, 3), Point2(-3, 0)};
  EXPECT_TRUE(triangulate(scan, map, 0.5).empty());
}

}  // namespace
}  // namespace slamsensor::core
