// A rangefinder that tells the same wherever it looks is told to be stuck, and no scan of it becomes a fix or
// a missing landmark; one that sees nothing anywhere is told to see nothing.
#include "tests/unit/firmware/scan/head_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;

const tests::FakePanTiltConfig kUnit;
const tests::FakeRangefinderConfig kRange{.rate_hz = 1000.0};

hal::RangeSample strong_posts(double pan_rad, double tilt_rad, hal::Stamp at) {
  hal::RangeSample sample = posts(pan_rad, tilt_rad, at);
  sample.strength = 900.0;
  sample.told_m = sample.range_m;
  return sample;
}

/// A head among posts whose rangefinder tells `sample` instead from a moment on.
struct StuckRig {
  explicit StuckRig(const hal::RangeSample& told)
      : sample(told),
        rig(short_scan(), kUnit, kRange, [this](double pan_rad, double tilt_rad, hal::Stamp at) {
          return is_stuck ? sample : strong_posts(pan_rad, tilt_rad, at);
        }) {}

  hal::RangeSample sample;
  bool is_stuck = false;
  HeadRig rig;
};

void expect_stuck(StuckRig& stuck, const std::string& words) {
  HeadRig& rig = stuck.rig;
  rig.run(60.0, 1);
  EXPECT_FALSE(rig.head.is_failing());
  stuck.is_stuck = true;
  const std::size_t ended = rig.taken.ended.size();
  const hal::Stamp begun = rig.now;
  while (!rig.head.is_failing() && rig.now - begun < std::chrono::seconds(30)) {
    rig.run(0.01);
  }
  EXPECT_LT(hal::to_seconds(rig.now - begun), 10.0) << "told with the first whole line";
  rig.run(30.0);
  EXPECT_TRUE(rig.head.is_failing());
  EXPECT_THAT(std::string(rig.head.problem()),
              MatchesRegex("rangefinder: all [0-9]+ readings of the scan " + words));
  EXPECT_LE(rig.head.problem().size(), 191U) << "an LCM status has no more room";
  EXPECT_EQ(rig.taken.ended.size(), ended) << "no scan is made of it";
  stuck.is_stuck = false;
  rig.run(60.0, ended + 1);
  EXPECT_EQ(rig.taken.ended.size(), ended + 1);
  EXPECT_FALSE(rig.head.is_failing());
  EXPECT_THAT(std::string(rig.head.problem()), IsEmpty());
}

TEST(StuckReadings, TheSameDistanceEverywhereIsTold) {
  StuckRig stuck({{}, 5.0, 900.0, hal::Echo::Return, 5.0});
  expect_stuck(stuck, "are identical \\(5.0 m\\): lens covered, or the device is stuck; .*");
}

TEST(StuckReadings, TheSameFaintDistanceEverywhereIsTold) {
  StuckRig stuck({{}, 0.0, 12.0, hal::Echo::Weak, 0.3});
  expect_stuck(stuck, "are identical \\(0.3 m\\): lens covered, or the device is stuck; .*");
}

TEST(StuckReadings, SaturatedReadingsEverywhereAreTold) {
  StuckRig stuck({{}, 0.0, 65535.0, hal::Echo::Saturated, 0.0});
  expect_stuck(stuck, "are saturated, too bright to be measured: look for what shines back .*");
}

TEST(StuckReadings, DistanceAndStrengthZeroEverywhereAreTold) {
  StuckRig stuck({{}, 0.0, 0.0, hal::Echo::None, 0.0});
  expect_stuck(stuck, "are distance 0 and strength 0: lens covered, or its receiver is dead; .*");
}

TEST(StuckReadings, NothingWithinRangeAnywhereIsToldButNoFault) {
  StuckRig empty({{}, 0.0, 12.0, hal::Echo::None, 180.0});
  empty.rig.run(60.0, 1);
  empty.is_stuck = true;
  const std::size_t ended = empty.rig.taken.ended.size();
  empty.rig.run(90.0, ended + 2);
  EXPECT_EQ(empty.rig.taken.ended.size(), ended + 2) << "an empty place is a scan without landmarks";
  EXPECT_FALSE(empty.rig.head.is_failing());
  EXPECT_THAT(
      std::string(empty.rig.head.problem()),
      MatchesRegex("rangefinder: all [0-9]+ readings of the scan are over range or without echo: .*"));
  empty.is_stuck = false;
  empty.rig.run(60.0, ended + 4);
  EXPECT_THAT(std::string(empty.rig.head.problem()), IsEmpty());
}

TEST(StuckReadings, ALineThatLooksAtTheSkyIsNoWord) {
  HeadRig rig(short_scan(), kUnit, kRange, [](double pan_rad, double tilt_rad, hal::Stamp at) {
    return tilt_rad > 0.004 ? hal::RangeSample{{}, 0.0, 12.0, hal::Echo::None, 180.0}
                            : strong_posts(pan_rad, tilt_rad, at);
  });
  while (rig.taken.ended.size() < 3 && rig.now < std::chrono::seconds(120)) {
    rig.run(0.05);
    ASSERT_THAT(std::string(rig.head.problem()), IsEmpty());
  }
  EXPECT_EQ(rig.taken.ended.size(), 3U);
}

TEST(StoppedProcess, IsNoBlockedAxisAndNoLostDevice) {
  HeadRig rig(short_scan(), kUnit, kRange, strong_posts);
  rig.run(60.0, 1);
  rig.run(1.5);
  rig.now += std::chrono::seconds(30);  // as after SIGSTOP and SIGCONT
  const std::size_t ended = rig.taken.ended.size();
  for (int i = 0; i < 400; ++i) {
    rig.run(0.05, ended + 1);
    ASSERT_FALSE(rig.head.is_failing()) << rig.head.problem();
    EXPECT_THAT(std::string(rig.head.problem()), testing::Not(HasSubstr("check what blocks it")));
  }
  EXPECT_GT(rig.taken.ended.size(), ended);
}

}  // namespace
}  // namespace slamsensor::firmware
