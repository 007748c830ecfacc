#include "tools/world/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr double kTight = 1e-12;

Ray ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  return {origin, direction.normalized()};
}

TEST(Cylinder, LevelRayThroughAxisAndOffAxis) {
  const Chord through = cylinder_chord(ray({0, 0, 1.5}, {1, 0, 0}), 10, 0, 0.25, -1, 8);
  EXPECT_NEAR(through.in_m, 9.75, kTight);
  EXPECT_NEAR(through.out_m, 10.25, kTight);
  const Chord off = cylinder_chord(ray({0, 0.15, 1.5}, {1, 0, 0}), 10, 0, 0.25, -1, 8);
  EXPECT_NEAR(off.in_m, 10.0 - std::sqrt(0.25 * 0.25 - 0.15 * 0.15), kTight);
  EXPECT_TRUE(cylinder_chord(ray({0, 0.2501, 1.5}, {1, 0, 0}), 10, 0, 0.25, -1, 8).empty());
}

TEST(Cylinder, SlantedRayIsLongerByTheCosine) {
  const double tilt = 10.0 * std::numbers::pi / 180.0;
  const Chord chord = cylinder_chord(ray({0, 0, 0}, {std::cos(tilt), 0, std::sin(tilt)}), 10, 0, 0.5, -1, 8);
  EXPECT_NEAR(chord.in_m, 9.5 / std::cos(tilt), kTight);
}

TEST(Cylinder, EndsAreFlatAndClosed) {
  EXPECT_TRUE(cylinder_chord(ray({0, 0, 2.01}, {1, 0, 0}), 10, 0, 0.5, 0, 2).empty());
  const Chord from_above = cylinder_chord(ray({10.2, 0, 5}, {0, 0, -1}), 10, 0, 0.5, 0, 2);
  EXPECT_NEAR(from_above.in_m, 3.0, kTight);
  EXPECT_NEAR(from_above.out_m, 5.0, kTight);
  EXPECT_TRUE(cylinder_chord(ray({10.6, 0, 5}, {0, 0, -1}), 10, 0, 0.5, 0, 2).empty());
}

TEST(Cylinder, BehindIsMissedAndInsideIsZero) {
  EXPECT_TRUE(cylinder_chord(ray({0, 0, 1}, {-1, 0, 0}), 10, 0, 0.5, 0, 2).empty());
  EXPECT_EQ(cylinder_chord(ray({10, 0, 1}, {1, 0, 0}), 10, 0, 0.5, 0, 2).in_m, 0.0);
}

TEST(Spheroid, AxesAndTangent) {
  const Chord level = spheroid_chord(ray({0, 0, 3}, {1, 0, 0}), 10, 0, 2, 2, 4);
  EXPECT_NEAR(level.in_m, 8.0, kTight);
  EXPECT_NEAR(level.out_m, 12.0, kTight);
  const Chord upright = spheroid_chord(ray({10, 0, 0}, {0, 0, 1}), 10, 0, 2, 2, 4);
  EXPECT_NEAR(upright.in_m, 2.0, kTight);
  EXPECT_NEAR(upright.out_m, 4.0, kTight);
  EXPECT_TRUE(spheroid_chord(ray({0, 0, 4.0001}, {1, 0, 0}), 10, 0, 2, 2, 4).empty());
}

TEST(Spheroid, EndsOfAnyChordAreOnItsSurface) {
  const Ray slanted = ray({-3, 1, 0.2}, {1, -0.1, 0.15});
  const Chord chord = spheroid_chord(slanted, 5, 0.5, 1.5, 0.5, 2.5);
  ASSERT_FALSE(chord.empty());
  for (const double t : {chord.in_m, chord.out_m}) {
    const Eigen::Vector3d p = slanted.origin_W + t * slanted.direction_W;
    const double level = std::hypot(p.x() - 5.0, p.y() - 0.5) / 1.5;
    EXPECT_NEAR(level * level + (p.z() - 1.5) * (p.z() - 1.5), 1.0, 1e-12);
  }
}

TEST(Box, FacesOfATurnedBox) {
  const double c = std::cos(0.5);
  const double s = std::sin(0.5);
  const Box box{{20, 5, 1}, {c, s}, {2, 1, 0.75}};
  const Eigen::Vector3d behind = box.centre_W - 10.0 * Eigen::Vector3d(c, s, 0);
  EXPECT_NEAR(box_chord(ray(behind, {c, s, 0}), box).in_m, 8.0, 1e-12);
  const Eigen::Vector3d beside = box.centre_W + 10.0 * Eigen::Vector3d(-s, c, 0);
  EXPECT_NEAR(box_chord(ray(beside, {s, -c, 0}), box).in_m, 9.0, 1e-12);
  EXPECT_TRUE(box_chord(ray(behind + Eigen::Vector3d(0, 0, 0.76), {c, s, 0}), box).empty());
}

TEST(Wall, DistanceEndsAndHeight) {
  const Eigen::Vector2d from(5, -2);
  const Eigen::Vector2d along(0, 4);
  EXPECT_NEAR(wall_distance_m(ray({0, 0, 1}, {1, 0, 0}), from, along, 0, 2), 5.0, kTight);
  EXPECT_NEAR(wall_distance_m(ray({10, 0, 1}, {-1, 0, 0}), from, along, 0, 2), 5.0, kTight);
  EXPECT_NEAR(wall_distance_m(ray({0, 0, 1}, {1, 0.39, 0}), from, along, 0, 2), 5.0 * std::hypot(1.0, 0.39),
              1e-9);
  EXPECT_EQ(wall_distance_m(ray({0, 0, 1}, {1, 0.41, 0}), from, along, 0, 2), kMiss);
  EXPECT_EQ(wall_distance_m(ray({0, 0, 2.1}, {1, 0, 0}), from, along, 0, 2), kMiss);
  EXPECT_EQ(wall_distance_m(ray({0, 0, 1}, {0, 1, 0}), from, along, 0, 2), kMiss);
  EXPECT_EQ(wall_distance_m(ray({0, 0, 1}, {-1, 0, 0}), from, along, 0, 2), kMiss);
}

}  // namespace
}  // namespace slamsensor::tools
