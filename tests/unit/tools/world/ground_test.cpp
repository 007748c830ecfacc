#include "tools/world/ground.hpp"

#include "core/config.hpp"
#include "tools/world/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

using core::kDegree;

Ray look(const Eigen::Vector3d& origin_W, double pan_rad, double tilt_rad) {
  return {
      origin_W,
      {std::cos(tilt_rad) * std::cos(pan_rad), std::cos(tilt_rad) * std::sin(pan_rad), std::sin(tilt_rad)}};
}

GroundConfig bumpy() {
  GroundConfig config;
  config.amplitude_m = 0.8;
  config.waves = 4;
  config.wavelength_m = {10.0, 40.0};
  config.slope_x = 0.02;
  config.slope_y = -0.03;
  return config;
}

TEST(Ground, FlatGroundAtKnownDepressions) {
  const Ground ground(GroundConfig{}, 1);
  for (const double depression_deg : {0.5, 2.0, 7.7, 18.0, 45.0, 90.0}) {
    const double distance_m = ground.distance_m(look({3, 4, 1.5}, 0.7, -depression_deg * kDegree), 300.0);
    EXPECT_NEAR(distance_m, 1.5 / std::sin(depression_deg * kDegree), 1e-9) << depression_deg;
  }
  EXPECT_EQ(ground.distance_m(look({0, 0, 1.5}, 0.0, -0.2 * kDegree), 300.0), kMiss);  // 430 m away
  EXPECT_EQ(ground.distance_m(look({0, 0, 1.5}, 0.0, 0.0), 300.0), kMiss);
}

TEST(Ground, SlopeMeetsALevelRay) {
  GroundConfig config;
  config.slope_x = 0.05;
  const Ground ground(config, 1);
  EXPECT_NEAR(ground.distance_m(look({0, 0, 1.5}, 0.0, 0.0), 300.0), 30.0, 1e-9);
  EXPECT_EQ(ground.distance_m(look({0, 0, 1.5}, std::numbers::pi, 0.0), 300.0), kMiss);
  EXPECT_NEAR(ground.height_m(10.0, 99.0), 0.5, 1e-12);
}

TEST(Ground, HeightStaysWithinTheAmplitudeAndIsNotFlat) {
  GroundConfig config = bumpy();
  config.slope_x = config.slope_y = 0.0;
  const Ground ground(config, 5);
  double low_m = 0.0;
  double high_m = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const double height_m = ground.height_m(-150.0 + 0.37 * (i % 800), 0.71 * i / 50.0);
    low_m = std::min(low_m, height_m);
    high_m = std::max(high_m, height_m);
  }
  EXPECT_GE(low_m, -0.8 - 1e-6);
  EXPECT_LE(high_m, 0.8 + 1e-6);
  EXPECT_GT(high_m - low_m, 0.6);
}

// Against marching by centimetres: the first crossing, whatever the direction.
TEST(Ground, MarchFindsTheFirstCrossing) {
  constexpr std::uint64_t kSeed = 77;
  SCOPED_TRACE(kSeed);
  const Ground ground(bumpy(), kSeed);
  Random rng(kSeed);
  int hits = 0;
  int differ = 0;
  for (int i = 0; i < 400; ++i) {
    const double x_m = draw_uniform(rng, -100.0, 100.0);
    const double y_m = draw_uniform(rng, -100.0, 100.0);
    const Ray ray = look({x_m, y_m, ground.height_m(x_m, y_m) + 1.5}, draw_uniform(rng, -3.1, 3.1),
                         draw_uniform(rng, -18.0, 2.0) * kDegree);
    double expected_m = kMiss;
    for (double t = 0.0; t < 100.0 && expected_m == kMiss; t += 0.01) {
      const Eigen::Vector3d p = ray.origin_W + t * ray.direction_W;
      expected_m = p.z() <= ground.height_m(p.x(), p.y()) ? t : kMiss;
    }
    const double found_m = ground.distance_m(ray, 100.0);
    hits += found_m < kMiss ? 1 : 0;
    differ += (found_m == kMiss) != (expected_m == kMiss) ||
              (found_m < kMiss && std::abs(found_m - expected_m) > 0.011);
  }
  EXPECT_GT(hits, 200);
  EXPECT_LE(differ, 2);  // crests that are cut over a few centimetres
}

TEST(Ground, EqualSeedsEqualGround) {
  const Ground a(bumpy(), 9);
  const Ground b(bumpy(), 9);
  const Ground c(bumpy(), 10);
  EXPECT_EQ(a.height_m(12.3, -45.6), b.height_m(12.3, -45.6));
  EXPECT_NE(a.height_m(12.3, -45.6), c.height_m(12.3, -45.6));
}

TEST(Ground, FromBelowTheGroundTheDistanceIsZero) {
  EXPECT_EQ(Ground(GroundConfig{}, 1).distance_m(look({0, 0, -0.1}, 0, 0), 300.0), 0.0);
  EXPECT_EQ(Ground(bumpy(), 1).distance_m(look({0, 0, -5.0}, 0, 0), 300.0), 0.0);
}

}  // namespace
}  // namespace slamsensor::tools
