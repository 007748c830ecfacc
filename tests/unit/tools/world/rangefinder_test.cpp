#include "tools/world/world.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace slamsensor::tools {
namespace {

TEST(Rangefinder, NoiseHasTheConfiguredSpread) {
  RangefinderConfig config;
  config.noise_sigma_m = 0.2;
  config.resolution_m = 0.0;
  Random rng(4);
  constexpr int kReadings = 100'000;
  double sum = 0.0;
  double sum2 = 0.0;
  for (int i = 0; i < kReadings; ++i) {
    const double error_m = disturb(config, 50.0, rng) - 50.0;
    sum += error_m;
    sum2 += error_m * error_m;
  }
  EXPECT_NEAR(sum / kReadings, 0.0, 0.003);
  EXPECT_NEAR(std::sqrt(sum2 / kReadings), 0.2, 0.002);
}

TEST(Rangefinder, QuantisesToTheNearestStep) {
  RangefinderConfig config;
  config.noise_sigma_m = 0.0;
  Random rng(1);
  EXPECT_NEAR(disturb(config, 12.34, rng), 12.3, 1e-12);
  EXPECT_NEAR(disturb(config, 12.36, rng), 12.4, 1e-12);
}

TEST(Rangefinder, LimitsGiveNoReturn) {
  RangefinderConfig config;
  config.noise_sigma_m = 0.0;
  Random rng(1);
  EXPECT_EQ(disturb(config, 300.01, rng), core::Reading::kNoReturn);
  EXPECT_NEAR(disturb(config, 299.96, rng), 300.0, 1e-9);
  EXPECT_EQ(disturb(config, 0.49, rng), core::Reading::kNoReturn);
  EXPECT_NEAR(disturb(config, 0.51, rng), 0.5, 1e-12);
}

TEST(Rangefinder, MixedPixelsAppearInTheirShare) {
  RangefinderConfig config;
  config.mixed_share = 0.25;
  Random rng(8);
  const std::array<double, 4> distances_m{10.0, 10.0, 10.0, 20.0};
  std::array<int, 3> counts{};  // near, far, between
  constexpr int kShots = 40'000;
  for (int i = 0; i < kShots; ++i) {
    const double range_m = combine_sub_rays(config, distances_m, rng);
    ++counts[range_m == 10.0 ? 0 : (range_m == 20.0 ? 1 : 2)];
    EXPECT_TRUE(range_m == 10.0 || range_m == 20.0 || range_m == 12.5) << range_m;
  }
  EXPECT_NEAR(static_cast<double>(counts[2]) / kShots, 0.25, 0.01);
  EXPECT_NEAR(static_cast<double>(counts[1]) / kShots, 0.75 * 0.25, 0.01);
}

TEST(Rangefinder, SubRaysThatAgreeAreAveraged) {
  const RangefinderConfig config;
  Random rng(8);
  const std::array<double, 3> distances_m{10.0, 10.1, 10.3};
  EXPECT_NEAR(combine_sub_rays(config, distances_m, rng), 10.4 - 0.8 / 3.0, 1e-12);
}

TEST(Rangefinder, BeamFillsItsConeAndNoMore) {
  RangefinderConfig config;
  config.divergence_rad = 0.02;
  config.sub_rays = 9;
  const BeamPattern beam(config);
  ASSERT_EQ(beam.count, 9U);
  EXPECT_EQ(std::hypot(beam.lean[0][0], beam.lean[0][1]), 0.0);
  for (std::uint32_t i = 1; i < beam.count; ++i) {
    EXPECT_LE(std::hypot(beam.lean[i][0], beam.lean[i][1]), std::tan(0.01) * (1.0 + 1e-12));
  }
  EXPECT_NEAR(std::hypot(beam.lean[8][0], beam.lean[8][1]), std::tan(0.01), 1e-12);
}

}  // namespace
}  // namespace slamsensor::tools
