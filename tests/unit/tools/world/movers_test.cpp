#include "tools/world/population.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

MoverConfig walker() {
  MoverConfig mover;
  mover.x1_m = 10.0;
  mover.y1_m = -5.0;
  mover.x2_m = 10.0;
  mover.y2_m = 5.0;
  mover.speed_mps = 2.0;
  return mover;
}

TEST(Movers, StraightPathGoesToAndFro) {
  EXPECT_NEAR(place_at(walker(), 2.5).position_W.y(), 0.0, 1e-12);
  EXPECT_NEAR(place_at(walker(), 5.0).position_W.y(), 5.0, 1e-12);
  EXPECT_NEAR(place_at(walker(), 6.0).position_W.y(), 3.0, 1e-12);
  EXPECT_NEAR(place_at(walker(), 6.0).forward_W.y(), -1.0, 1e-12);
  EXPECT_NEAR(place_at(walker(), -1.0).position_W.y(), -3.0, 1e-12);
  EXPECT_NEAR(place_at(walker(), 1002.5).position_W.y(), 0.0, 1e-9);
}

TEST(Movers, CircleKeepsItsRadiusAndSense) {
  MoverConfig mover = walker();
  mover.circle_radius_m = 4.0;
  mover.speed_mps = -2.0;
  const MoverPlace start = place_at(mover, 0.0);
  EXPECT_NEAR(start.position_W.x(), 14.0, 1e-12);
  EXPECT_NEAR(start.forward_W.y(), -1.0, 1e-12);
  const MoverPlace later = place_at(mover, std::numbers::pi);  // a quarter of the circle, clockwise
  EXPECT_NEAR((later.position_W - core::Point2(10.0, -9.0)).norm(), 0.0, 1e-12);
}

TEST(Movers, PersonIsHitWhereItIsAtThatTime) {
  const Movers movers({walker()}, BodyConfig{});
  const Ground ground(GroundConfig{}, 1);
  const Ray ahead{{0, 0, 1.5}, {1, 0, 0}};
  const Movers::Hit hit = movers.first_hit(ahead, 300.0, 2.5, ground);
  EXPECT_EQ(hit.surface, Surface::Person);
  EXPECT_NEAR(hit.distance_m, 9.75, 1e-12);
  EXPECT_EQ(movers.first_hit(ahead, 300.0, 1.0, ground).surface, Surface::None);
  EXPECT_EQ(movers.first_hit(ahead, 9.0, 2.5, ground).surface, Surface::None);
  EXPECT_EQ(movers.first_hit({{0, 0, 1.8}, {1, 0, 0}}, 300.0, 2.5, ground).surface, Surface::None);
}

TEST(Movers, CarShowsItsSideWhenItDrivesAcross) {
  MoverConfig car = walker();
  car.kind = MoverKind::Car;
  const Movers movers({car, walker()}, BodyConfig{});
  const Movers::Hit hit = movers.first_hit({{0, 0, 1}, {1, 0, 0}}, 300.0, 2.5, Ground(GroundConfig{}, 1));
  EXPECT_EQ(hit.surface, Surface::Car);
  EXPECT_EQ(hit.mover, 0U);
  EXPECT_NEAR(hit.distance_m, 10.0 - 0.9, 1e-12);
}

}  // namespace
}  // namespace slamsensor::tools
