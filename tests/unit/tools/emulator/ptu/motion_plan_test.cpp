#include "tools/emulator/ptu/motion_plan.hpp"

#include "tools/world/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;

// The next speed towards a target at `ahead` of a motor that decides anew every `step_s`.
double next_speed(double speed, double ahead, const StepperRates& rates, double step_s) {
  const double change = rates.acceleration * step_s;
  const double brake = (speed * speed - rates.base * rates.base) / (2.0 * rates.acceleration);
  const double want = speed > rates.base && brake >= ahead ? 0.0 : rates.speed;
  if (speed < -rates.base) {
    return speed + change;
  }
  if (speed > rates.base && want < speed) {
    return std::max(want, speed - change);
  }
  return std::min(want, want > rates.base ? std::max(speed, rates.base) + change : want);
}

// The same motor by brute force.
double integrated_duration_s(StepperState state, double target, const StepperRates& rates, double step_s) {
  double time_s = 0.0;
  while (time_s < 200.0) {
    const double ahead = target - state.position;
    const double slow = std::min(rates.base, rates.speed);
    if (std::abs(ahead) <= slow * step_s &&
        std::abs(state.speed) <= rates.base + rates.acceleration * step_s) {
      break;
    }
    const double direction = ahead > 0.0 ? 1.0 : -1.0;
    state.speed = direction * next_speed(direction * state.speed, std::abs(ahead), rates, step_s);
    state.position += state.speed * step_s;
    time_s += step_s;
  }
  return time_s;
}

double duration_s(const MotionPlan& plan) {
  double sum = 0.0;
  for (const MotionLeg& leg : plan.legs) {
    EXPECT_GE(leg.duration_s, 0.0);
    sum += leg.duration_s;
  }
  return sum;
}

double way(const MotionPlan& plan) {
  double sum = 0.0;
  for (const MotionLeg& leg : plan.legs) {
    sum += (leg.speed + 0.5 * leg.acceleration * leg.duration_s) * leg.duration_s;
  }
  return sum;
}

TEST(MotionPlan, GoesAtConstantSpeedUpToTheBaseSpeed) {
  const MotionPlan plan = plan_move({-2500.0, 0.0}, 2500.0, {1000.0, 1000.0, 2000.0});
  ASSERT_EQ(plan.legs.size(), 1U);
  EXPECT_DOUBLE_EQ(plan.legs[0].duration_s, 5.0);
  EXPECT_DOUBLE_EQ(plan.legs[0].speed, 1000.0);
  EXPECT_EQ(plan.end, 2500.0);
}

TEST(MotionPlan, IsATrapezoidAboveTheBaseSpeed) {
  // 1000 to 2000 at 2000/s^2: 0.5 s and 750 positions for each ramp.
  const MotionPlan plan = plan_move({0.0, 0.0}, -3500.0, {2000.0, 1000.0, 2000.0});
  ASSERT_EQ(plan.legs.size(), 3U);
  EXPECT_DOUBLE_EQ(plan.legs[0].duration_s, 0.5);
  EXPECT_DOUBLE_EQ(plan.legs[1].duration_s, 1.0);
  EXPECT_DOUBLE_EQ(plan.legs[1].speed, -2000.0);
  EXPECT_DOUBLE_EQ(plan.legs[2].duration_s, 0.5);
}

TEST(MotionPlan, ComesFromEveryStateToItsTargetAsAnIntegrationDoes) {
  constexpr std::uint64_t kSeed = 3;
  Random rng(kSeed);
  for (int i = 0; i < 300; ++i) {
    const StepperRates rates{draw_uniform(rng, 100.0, 3000.0), draw_uniform(rng, 50.0, 1200.0),
                             draw_uniform(rng, 500.0, 5000.0)};
    const StepperState state{std::round(draw_uniform(rng, -3000.0, 3000.0)),
                             draw_uniform(rng, -3000.0, 3000.0)};
    const double target = std::round(draw_uniform(rng, -3000.0, 3000.0));
    const MotionPlan plan = plan_move(state, target, rates);
    EXPECT_NEAR(state.position + way(plan), target, 1e-6) << "seed " << kSeed << " case " << i;
    EXPECT_EQ(plan.end, target);
    // One position to and fro costs the integration up to a position's time at the slowest speed.
    const double slow = std::min(rates.base, rates.speed);
    EXPECT_NEAR(duration_s(plan), integrated_duration_s(state, target, rates, 5e-5), 0.004 + 2.5 / slow)
        << "seed " << kSeed << " case " << i << " speed " << rates.speed << " base " << rates.base << " from "
        << state.speed;
  }
}

TEST(MotionPlan, StopsAtAWholePositionAndNoEarlierThanItCan) {
  constexpr std::uint64_t kSeed = 5;
  Random rng(kSeed);
  for (int i = 0; i < 300; ++i) {
    const StepperRates rates{1000.0, draw_uniform(rng, 50.0, 1200.0), draw_uniform(rng, 500.0, 5000.0)};
    const StepperState state{draw_uniform(rng, -3000.0, 3000.0), draw_uniform(rng, -3000.0, 3000.0)};
    const MotionPlan plan = plan_stop(state, rates);
    const double speed = std::abs(state.speed);
    const double brake = std::max(speed * speed - rates.base * rates.base, 0.0) / (2.0 * rates.acceleration);
    const double gone = std::abs(plan.end - state.position);
    EXPECT_EQ(plan.end, std::round(plan.end)) << "seed " << kSeed << " case " << i;
    EXPECT_GE(gone, brake - 1e-6);
    EXPECT_LE(gone, brake + 1.0);
    EXPECT_NEAR(state.position + way(plan), plan.end, 1e-6);
  }
}

TEST(Trajectory, RestsUntilCommandedAndEndsExactly) {
  Trajectory motion(7.0);
  EXPECT_EQ(motion.position(-5s), 7.0);
  EXPECT_EQ(motion.leaves(0s, -10.0, 10.0), hal::kNever);
  motion.follow(1s, {{{2.0, 10.0, 0.0}}, 27.0});
  EXPECT_EQ(motion.position(500ms), 7.0);
  EXPECT_NEAR(motion.position(2s), 17.0, 1e-12);
  EXPECT_EQ(motion.speed(2s), 10.0);
  EXPECT_EQ(motion.still_from(), 3s);
  EXPECT_EQ(motion.position(3s), 27.0);
  EXPECT_EQ(motion.speed(3s), 0.0);
}

TEST(Trajectory, KnowsWhenItLeavesARange) {
  Trajectory motion(0.0);
  motion.follow(1s, {{{4.0, 0.0, 8.0}}, 64.0});  // 4 t^2
  EXPECT_EQ(motion.leaves(0s, -100.0, 16.0), 3s);
  EXPECT_EQ(motion.leaves(4s, -100.0, 16.0), 4s);  // is out already
  EXPECT_EQ(motion.leaves(0s, -100.0, 64.0), hal::kNever);
  Trajectory down(0.0);
  down.follow(0s, {{{2.0, -10.0, 0.0}, {3.0, -10.0, 2.0}}, -41.0});
  EXPECT_EQ(down.leaves(0s, -10.0, 5.0), 1s);
  EXPECT_NEAR(hal::to_seconds(down.leaves(0s, -29.0, 5.0)), 3.0, 1e-9);  // 10 t - t^2 = 9 after 2 s
}

TEST(Trajectory, MissedStepsMoveTheTruthAndNotTheCount) {
  Trajectory motion(0.0);
  motion.follow(0s, {{{10.0, 10.0, 0.0}}, 100.0});
  motion.miss(4s, -5.0);
  EXPECT_NEAR(motion.truth(3s), 30.0, 1e-9);
  EXPECT_NEAR(motion.truth(4s), 35.0, 1e-9);
  EXPECT_NEAR(motion.position(4s), 40.0, 1e-9);
  EXPECT_EQ(motion.truth(10s), 95.0);
  EXPECT_NEAR(hal::to_seconds(motion.leaves(0s, 0.0, 55.0)), 6.0, 1e-9);
  motion.rest(20s, 0.0, 0.0);
  EXPECT_EQ(motion.truth(20s), 0.0);
  motion.forget(19s);
  EXPECT_EQ(motion.truth(19s), 95.0);
}

}  // namespace
}  // namespace slamsensor::tools
