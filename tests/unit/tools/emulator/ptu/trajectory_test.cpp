#include "tools/emulator/ptu/motion_plan.hpp"

#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;

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
