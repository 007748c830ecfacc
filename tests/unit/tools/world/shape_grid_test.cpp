#include "tools/world/random.hpp"
#include "tools/world/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

Shape draw_shape(Random& rng, std::uint32_t index) {
  Shape shape;
  const std::uint64_t form = rng() % 4;
  shape.form = form == 0 ? ShapeForm::Wall : (form == 1 ? ShapeForm::Spheroid : ShapeForm::Cylinder);
  shape.surface = form == 0 ? Surface::Wall : (form == 1 ? Surface::Rock : Surface::Post);
  shape.object = index;
  shape.x_m = draw_uniform(rng, -60.0, 60.0);
  shape.y_m = draw_uniform(rng, -40.0, 40.0);
  shape.z_low_m = draw_uniform(rng, -1.0, 0.0);
  shape.z_high_m = draw_uniform(rng, 0.5, 6.0);
  shape.radius_m = form == 0 ? 0.0 : draw_uniform(rng, 0.1, 4.0);
  shape.along_x_m = form == 0 ? draw_uniform(rng, -20.0, 20.0) : 0.0;
  shape.along_y_m = form == 0 ? draw_uniform(rng, -20.0, 20.0) : 0.0;
  return shape;
}

Ray draw_ray(Random& rng) {
  const double x_m = draw_uniform(rng, -90.0, 90.0);
  const double y_m = draw_uniform(rng, -70.0, 70.0);
  const double pan = static_cast<double>(rng() % 16) * 0.3926990816987241;  // some along the axes of the grid
  const double tilt = draw_uniform(rng, -0.3, 0.3);
  return {{x_m, y_m, 1.5}, {std::cos(tilt) * std::cos(pan), std::cos(tilt) * std::sin(pan), std::sin(tilt)}};
}

// A grid of one shape has nothing to leave out: the nearest over all of them is the reference.
TEST(ShapeGrid, FindsWhatTestingEveryShapeFinds) {
  constexpr std::uint64_t kSeed = 3;
  SCOPED_TRACE(kSeed);
  Random rng(kSeed);
  std::vector<Shape> shapes;
  std::vector<ShapeGrid> singles;
  for (std::uint32_t i = 0; i < 120; ++i) {
    shapes.push_back(draw_shape(rng, i));
    singles.emplace_back(std::span(&shapes.back(), 1));
  }
  const ShapeGrid grid(shapes);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Ray ray = draw_ray(rng);
    const double limit_m = i % 5 == 0 ? 20.0 : 300.0;
    Hit expected;
    for (const ShapeGrid& single : singles) {
      const Hit hit = single.first_hit(ray, limit_m, 0);
      expected = hit.distance_m < expected.distance_m ? hit : expected;
    }
    const Hit found = grid.first_hit(ray, limit_m, 0);
    EXPECT_EQ(found.distance_m, expected.distance_m) << "ray " << i;
    EXPECT_EQ(found.index, expected.index) << "ray " << i;
    hits += found.surface != Surface::None ? 1 : 0;
  }
  EXPECT_GT(hits, 1000);
}

TEST(ShapeGrid, PorousShapeStopsTheShareThatTheChordImplies) {
  Shape crown;
  crown.form = ShapeForm::Spheroid;
  crown.surface = Surface::Crown;
  crown.x_m = 20.0;
  crown.z_low_m = -2.0;
  crown.z_high_m = 2.0;
  crown.radius_m = 2.0;  // a chord of 4 m through the middle
  crown.stops_per_m = 0.3;
  const ShapeGrid grid(std::span(&crown, 1));
  constexpr int kRays = 50'000;
  Random rng(21);
  int stopped = 0;
  double depth_sum_m = 0.0;
  for (int i = 0; i < kRays; ++i) {
    const Hit hit = grid.first_hit({}, 300.0, rng());
    if (hit.surface == Surface::Crown) {
      ++stopped;
      depth_sum_m += hit.distance_m - 18.0;
      EXPECT_GE(hit.distance_m, 18.0);
      EXPECT_LE(hit.distance_m, 22.0);
    }
  }
  const double passes = std::exp(-0.3 * 4.0);
  EXPECT_NEAR(static_cast<double>(stopped) / kRays, 1.0 - passes, 0.01);
  const double mean_depth_m = 1.0 / 0.3 - 4.0 * passes / (1.0 - passes);  // exponential cut off at 4 m
  EXPECT_NEAR(depth_sum_m / stopped, mean_depth_m, 0.03);
}

TEST(ShapeGrid, EmptyGridIsMissed) {
  EXPECT_EQ(ShapeGrid({}).first_hit({}, 300.0, 1).surface, Surface::None);
}

}  // namespace
}  // namespace slamsensor::tools
