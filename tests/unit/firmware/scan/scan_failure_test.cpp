// A head whose devices answer and which makes no scans says so, with the device, what was asked, what was
// seen and what to do; and it stops saying so with the first whole pass.
#include "tests/unit/firmware/scan/head_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::StartsWith;

const tests::FakePanTiltConfig kUnit;
const tests::FakeRangefinderConfig kRange{.rate_hz = 1000.0};

std::string told(const HeadRig& rig) {
  return std::string(rig.head.problem());
}

HeadRig scanning_rig() {
  return {short_scan(), kUnit, kRange, posts};
}

/// Runs until it is told to be failing; the seconds that took.
double run_until_failing(HeadRig& rig, double most_s) {
  const hal::Stamp begun = rig.now;
  while (!rig.head.is_failing() && hal::to_seconds(rig.now - begun) < most_s) {
    rig.run(0.01);
  }
  return hal::to_seconds(rig.now - begun);
}

void expect_recovery(HeadRig& rig) {
  const std::size_t ended = rig.taken.ended.size();
  rig.run(60.0, ended + 1);
  EXPECT_EQ(rig.taken.ended.size(), ended + 1);
  EXPECT_FALSE(rig.head.is_failing());
  EXPECT_THAT(told(rig), IsEmpty());
}

TEST(ScanFailure, ABlockedAxisIsReportedAtItsFirstStall) {
  HeadRig rig = scanning_rig();
  rig.run(60.0, 1);
  EXPECT_FALSE(rig.head.is_failing());
  rig.unit.pan.stall_rad = 0.1;
  rig.unit.pan.stall_s = std::numeric_limits<double>::infinity();
  EXPECT_LT(run_until_failing(rig, 60.0), 15.0);
  EXPECT_THAT(told(rig),
              MatchesRegex("pan-tilt unit: pan was sent from -?[0-9.]+ to -?[0-9.]+ deg and (stands at "
                           "5\\.[0-9] deg|has not moved) after [0-9.]+ s; check what blocks it, its "
                           "motor's supply, its cable"));
  rig.run(30.0);
  EXPECT_TRUE(rig.head.is_failing());
  EXPECT_THAT(told(rig), HasSubstr(" times in a row; check"));
  EXPECT_LE(told(rig).size(), 191U) << "an LCM status has no more room: " << told(rig);
  rig.unit.pan.stall_s = 0.0;
  expect_recovery(rig);
}

TEST(ScanFailure, ARefusedMoveIsReportedWithTheMove) {
  HeadRig rig = scanning_rig();
  rig.unit.answer = hal::MoveStatus::OutOfRange;
  EXPECT_LT(run_until_failing(rig, 60.0), 1.0);
  EXPECT_THAT(told(rig),
              MatchesRegex("pan-tilt unit: it refused to send (pan|tilt) to -?[0-9.]+ deg at [0-9.]+ "
                           "deg/s; check its limits and the settings \\[scan\\]"));
  rig.unit.answer = hal::MoveStatus::Accepted;
  expect_recovery(rig);
}

TEST(ScanFailure, AUnitThatTakesNoMoveStandsStill) {
  HeadRig rig = scanning_rig();
  rig.unit.answer = hal::MoveStatus::Busy;
  EXPECT_LT(run_until_failing(rig, 60.0), 5.0);
  EXPECT_THAT(told(rig), HasSubstr("deg and has not moved after 2.0 s"));
  rig.unit.answer = hal::MoveStatus::Accepted;
  expect_recovery(rig);
}

TEST(ScanFailure, WithoutReadingsTheThirdLineSaysWhy) {
  SensorHeadConfig config = short_scan();
  config.scan.lines_rejected_max_share = 1.0;  // no scan is given up for them
  HeadRig rig(config, kUnit, kRange, posts);
  rig.run(60.0, 1);
  rig.rangefinder.is_silent = true;
  const std::uint64_t swept = rig.head.scheduler().count(SchedulerEvent::LinesSwept);
  run_until_failing(rig, 120.0);
  EXPECT_LE(rig.head.scheduler().count(SchedulerEvent::LinesSwept) - swept, 4U);
  EXPECT_THAT(told(rig), StartsWith("rangefinder: 3 scanlines in a row had no reading that can be used"));
  rig.rangefinder.is_silent = false;
  expect_recovery(rig);
}

TEST(ScanFailure, AScanGivenUpForItsLinesReportsWhatTheyLacked) {
  HeadRig rig = scanning_rig();
  rig.run(60.0, 1);
  rig.rangefinder.is_silent = true;
  run_until_failing(rig, 120.0);
  EXPECT_THAT(told(rig),
              MatchesRegex("rangefinder: [0-9]+ of [0-9]+ scanlines had no reading that can be used.*"));
  EXPECT_LE(told(rig).size(), 191U) << told(rig);
  rig.rangefinder.is_silent = false;
  expect_recovery(rig);
}

TEST(ScanFailure, PositionsThatComeTooLateAreBlamedOnThePanTiltUnit) {
  tests::FakePanTiltConfig slow = kUnit;
  slow.poll_hz = 0.5;
  HeadRig rig(short_scan(), slow, kRange, posts);
  run_until_failing(rig, 120.0);
  EXPECT_TRUE(rig.head.is_failing());
  EXPECT_THAT(told(rig), StartsWith("pan-tilt unit: "));
  EXPECT_LE(told(rig).size(), 191U) << told(rig);
}

TEST(ScanFailure, ADeviceThatIsLostInEveryScanIsReportedWhenItIsBack) {
  for (const bool is_pan_tilt : {true, false}) {
    HeadRig rig = scanning_rig();
    rig.run(60.0, 1);
    hal::DeviceState& state = is_pan_tilt ? rig.unit.device_state : rig.rangefinder.device_state;
    for (int time = 0; time < 2; ++time) {
      rig.run(5.0);
      state = hal::DeviceState::Absent;
      rig.run(0.5);
      state = hal::DeviceState::Ready;
      rig.run(0.1);
      EXPECT_EQ(rig.head.is_failing(), time == 1) << "one loss may be a plug that was touched";
    }
    EXPECT_THAT(told(rig),
                StartsWith(is_pan_tilt ? "pan-tilt unit: it was lost in the scan, 2 times in a row: "
                                       : "rangefinder: it was lost in the scan, 2 times in a row; "));
    EXPECT_LE(told(rig).size(), 191U) << told(rig);
    expect_recovery(rig);
  }
}

TEST(ScanFailure, WhatTheUserAndTheCarrierDoIsNone) {
  HeadRig rig = scanning_rig();
  rig.run(60.0, 1);
  for (int time = 0; time < 4; ++time) {
    rig.run(2.0);
    rig.head.abort_scan();
    rig.run(2.0);
    rig.head.hold(HoldReason::Paused);
    rig.run(0.1);
    rig.head.release(HoldReason::Paused);
  }
  EXPECT_FALSE(rig.head.is_failing());
  EXPECT_THAT(told(rig), IsEmpty());
}

TEST(ScanFailure, APlanThatCannotBeMadeIsAFailure) {
  HeadRig rig = scanning_rig();
  rig.unit.info().pan.min_rad = 0.95 * rig.unit.info().pan.max_rad;
  EXPECT_LT(run_until_failing(rig, 10.0), 1.0);
  EXPECT_THAT(told(rig), HasSubstr("pan limits"));
}

}  // namespace
}  // namespace slamsensor::firmware
