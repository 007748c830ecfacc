#include "hal/pantilt/pan_tilt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace slamsensor::hal {
namespace {

struct Case {
  double start = 0.0;
  double target = 0.0;
  double speed = 0.0;
  AxisDynamics dynamics;
};

Case drawn(std::uint32_t seed) {
  std::mt19937 engine(seed);
  const auto draw = [&engine](double low, double high) {
    return low + (high - low) * static_cast<double>(engine()) / 4294967296.0;
  };
  Case made{draw(-3.0, 3.0), draw(-3.0, 3.0), draw(0.01, 3.0), {}};
  made.dynamics.base_speed_radps = seed % 4 == 0 ? 0.0 : draw(0.0, 2.0);
  made.dynamics.acceleration_radps2 = seed % 5 == 0 ? 0.0 : draw(0.1, 10.0);
  return made;
}

class MotionProfileLaws : public testing::TestWithParam<std::uint32_t> {
 protected:
  Case given = drawn(GetParam());
  MotionProfile profile{given.start, given.target, given.speed, given.dynamics};
};

TEST_P(MotionProfileLaws, GoesFromStartToTarget) {
  EXPECT_EQ(profile.position_rad(-1.0), given.start);
  EXPECT_EQ(profile.position_rad(0.0), given.start);
  EXPECT_NEAR(profile.target_rad(), given.target, 1e-12);
  EXPECT_EQ(profile.position_rad(profile.duration_s()), profile.target_rad());
  EXPECT_EQ(profile.position_rad(profile.duration_s() + 1e3), profile.target_rad());
}

TEST_P(MotionProfileLaws, IsContinuousAndNeverFasterThanAsked) {
  const double step_s = profile.duration_s() / 1000.0;
  const double towards = given.target < given.start ? -1.0 : 1.0;
  for (int i = 0; i <= 1001; ++i) {
    const double way = towards * (profile.position_rad(i * step_s) - profile.position_rad((i - 1) * step_s));
    EXPECT_GE(way, -1e-12) << "seed " << GetParam() << " step " << i;
    EXPECT_LE(way, given.speed * step_s * (1.0 + 1e-9) + 1e-12) << "seed " << GetParam() << " step " << i;
    EXPECT_LE(std::abs(profile.speed_radps(i * step_s)), given.speed * (1.0 + 1e-9));
  }
}

TEST_P(MotionProfileLaws, SpeedIsTheSlopeOfPosition) {
  constexpr double kStep = 1e-6;
  for (int i = 1; i < 20; ++i) {
    const double t = profile.duration_s() * (i + 0.123) / 21.0;
    const double slope = (profile.position_rad(t + kStep) - profile.position_rad(t - kStep)) / (2.0 * kStep);
    EXPECT_NEAR(profile.speed_radps(t), slope, 1e-4) << "seed " << GetParam();
  }
}

TEST_P(MotionProfileLaws, AccelerationIsKept) {
  const double step_s = profile.duration_s() / 500.0;
  for (int i = 1; i + 1 < 500; ++i) {
    const double change = profile.speed_radps((i + 1) * step_s) - profile.speed_radps(i * step_s);
    EXPECT_LE(std::abs(change), given.dynamics.acceleration_radps2 * step_s + 1e-9) << "seed " << GetParam();
  }
}

TEST_P(MotionProfileLaws, ElapsedInvertsPosition) {
  for (int i = 1; i < 50; ++i) {
    const double t = profile.duration_s() * i / 50.0;
    EXPECT_NEAR(profile.elapsed_s(profile.position_rad(t)), t, 1e-7) << "seed " << GetParam();
  }
  EXPECT_EQ(profile.elapsed_s(given.start), 0.0);
  EXPECT_EQ(profile.elapsed_s(given.start - (given.target - given.start)), 0.0);
  EXPECT_EQ(profile.elapsed_s(given.target + (given.target - given.start)), profile.duration_s());
}

INSTANTIATE_TEST_SUITE_P(Seeds, MotionProfileLaws, testing::Range(1U, 41U));

TEST(MotionProfile, RunsAtConstantSpeedUpToTheBaseSpeed) {
  const MotionProfile profile(-1.0, 1.0, 0.5, {0.5, 10.0});
  EXPECT_DOUBLE_EQ(profile.duration_s(), 4.0);
  EXPECT_DOUBLE_EQ(profile.speed_radps(0.0), 0.5);
  EXPECT_DOUBLE_EQ(profile.speed_radps(3.9), 0.5);
  EXPECT_DOUBLE_EQ(profile.position_rad(1.0), -0.5);
}

TEST(MotionProfile, IsATrapezoidOnTopOfTheBaseSpeed) {
  // 1 to 3 rad/s at 2 rad/s^2: 1 s and 2 rad for each ramp, 6 rad in between at 3 rad/s.
  const MotionProfile profile(0.0, -10.0, 3.0, {1.0, 2.0});
  EXPECT_DOUBLE_EQ(profile.duration_s(), 4.0);
  EXPECT_DOUBLE_EQ(profile.speed_radps(0.0), -1.0);
  EXPECT_DOUBLE_EQ(profile.speed_radps(0.5), -2.0);
  EXPECT_DOUBLE_EQ(profile.speed_radps(2.0), -3.0);
  EXPECT_DOUBLE_EQ(profile.position_rad(1.0), -2.0);
  EXPECT_DOUBLE_EQ(profile.position_rad(3.0), -8.0);
}

TEST(MotionProfile, IsATriangleWhenTheWayIsShort) {
  // Half the way at 2 rad/s^2 from 1 rad/s: reaches sqrt(1 + 2 * 1.5) = 2 rad/s, not 3.
  const MotionProfile profile(0.0, 1.5, 3.0, {1.0, 2.0});
  EXPECT_DOUBLE_EQ(profile.duration_s(), 1.0);
  EXPECT_NEAR(profile.speed_radps(0.5), 2.0, 1e-9);
  EXPECT_NEAR(profile.position_rad(0.5), 0.75, 1e-12);
}

TEST(MotionProfile, WithoutAccelerationNeverPassesTheBaseSpeed) {
  const MotionProfile profile(0.0, 2.0, 3.0, {1.0, 0.0});
  EXPECT_DOUBLE_EQ(profile.duration_s(), 2.0);
}

TEST(MotionProfile, NoWayOrNoSpeedIsNoMove) {
  for (const MotionProfile& profile :
       {MotionProfile(0.5, 0.5, 1.0, {1.0, 1.0}), MotionProfile(0.5, 1.0, 0.0, {1.0, 1.0}),
        MotionProfile(0.5, std::nan(""), 1.0, {1.0, 1.0})}) {
    EXPECT_EQ(profile.duration_s(), 0.0);
    EXPECT_EQ(profile.position_rad(1.0), 0.5);
    EXPECT_EQ(profile.speed_radps(0.0), 0.0);
    EXPECT_EQ(profile.elapsed_s(0.5), 0.0);
  }
}

}  // namespace
}  // namespace slamsensor::hal
