// What stops a scan and what begins the next: holds, requests, modes, commands, a head that is pushed.

#include "tests/unit/firmware/scan/head_scene.hpp"

#include <gtest/gtest.h>

#include <string>

namespace slamsensor::firmware {
namespace {

constexpr tests::FakePanTiltConfig kUnit{.latency_s = 0.006, .jitter_s = 0.001, .slowness = 1e-4};
constexpr tests::FakeRangefinderConfig kRange{.latency_s = 0.002};

SensorHeadConfig in_mode(ScanMode mode) {
  SensorHeadConfig config = short_scan();
  config.scan.mode = mode;
  return config;
}

/// A rig in the middle of its second scan.
HeadRig scanning_rig() {
  return HeadRig(short_scan(), kUnit, kRange, posts);
}

void run_into_second_scan(HeadRig& rig) {
  rig.run(60.0, 1);
  rig.run(4.0);
  ASSERT_EQ(rig.taken.begun.size(), 2U);
  ASSERT_EQ(rig.head.scheduler().state(), SchedulerState::Sweeping);
}

TEST(Hold, EndsTheScanAtOnceAndHaltsTheUnit) {
  for (const HoldReason reason : {HoldReason::InterlockOpen, HoldReason::Paused}) {
    HeadRig rig = scanning_rig();
    run_into_second_scan(rig);
    const int halts = rig.unit.halts;
    rig.head.hold(reason);
    rig.run(0.002);
    ASSERT_EQ(rig.taken.aborted.size(), 1U);
    EXPECT_EQ(rig.taken.aborted[0].scan, 1U);
    EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::Held);
    EXPECT_EQ(rig.unit.halts, halts + 1);
    EXPECT_EQ(rig.head.problem(), describe(reason));
    EXPECT_EQ(rig.head.scheduler().held(), reason);
    const double pan_rad = rig.unit.pan.true_rad(rig.now);
    rig.run(60.0);
    EXPECT_EQ(rig.unit.pan.true_rad(rig.now), pan_rad) << "nothing moves while it is held";
    EXPECT_EQ(rig.taken.begun.size(), 2U);
    rig.head.release(reason);
    rig.run(0.002);
    EXPECT_EQ(rig.taken.begun.size(), 3U) << "without the rest after other aborts";
    EXPECT_TRUE(rig.head.problem().empty());
    const std::size_t lines = rig.taken.lines.size();
    rig.run(60.0, 2);
    ASSERT_EQ(rig.taken.ended.size(), 2U);
    EXPECT_EQ(rig.taken.ended[1].scan, 2U);
    EXPECT_EQ(rig.taken.ended[1].lines, 3U) << "a scan from its beginning";
    EXPECT_EQ(rig.taken.lines.at(lines).line, 0U);
    EXPECT_EQ(rig.taken.problem_with_order(), nullptr);
  }
}

TEST(Hold, EachReasonIsLiftedByItself) {
  HeadRig rig = scanning_rig();
  rig.head.hold(HoldReason::Paused);
  rig.head.hold(HoldReason::InterlockOpen);
  rig.head.hold(HoldReason::Paused);
  rig.run(5.0);
  rig.head.release(HoldReason::Paused);
  rig.run(5.0);
  EXPECT_TRUE(rig.taken.begun.empty());
  EXPECT_EQ(rig.head.scheduler().held(), HoldReason::InterlockOpen);
  EXPECT_EQ(rig.head.scheduler().count(SchedulerEvent::HoldsBegun), 1U);
  rig.head.release(HoldReason::InterlockOpen);
  rig.run(60.0, 1);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
}

TEST(Hold, StopsTheCalibrationTooWhichIsMadeAnew) {
  HeadRig rig = scanning_rig();
  rig.run(2.0);
  ASSERT_EQ(rig.head.scheduler().pass(), ScanPass::Calibration);
  rig.head.hold(HoldReason::Paused);
  rig.run(5.0);
  EXPECT_TRUE(rig.taken.aborted.empty()) << "no scan had begun";
  EXPECT_EQ(rig.head.scheduler().count(SchedulerEvent::AbortedHeld), 1U);
  rig.head.release(HoldReason::Paused);
  rig.run(60.0, 1);
  EXPECT_EQ(rig.head.scheduler().count(SchedulerEvent::CalibrationsFinished), 1U);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
}

TEST(Hold, OutlivesALossOfTheUnit) {
  HeadRig rig = scanning_rig();
  run_into_second_scan(rig);
  rig.unit.device_state = hal::DeviceState::Absent;
  rig.run(1.0);
  rig.head.hold(HoldReason::InterlockOpen);
  rig.run(1.0);
  EXPECT_EQ(rig.head.problem(), "fake unit is not ready") << "what stays when the hold is lifted";
  rig.unit.device_state = hal::DeviceState::Ready;
  const int halts = rig.unit.halts;
  rig.run(10.0);
  EXPECT_EQ(rig.taken.begun.size(), 2U);
  EXPECT_GE(rig.unit.halts, halts);
  EXPECT_EQ(rig.head.problem(), describe(HoldReason::InterlockOpen));
}

TEST(Requests, OneWaitsWhileAScanIsUnderWay) {
  HeadRig rig(in_mode(ScanMode::Single), kUnit, kRange, posts);
  rig.head.request_scan();
  rig.run(60.0, 1);
  ASSERT_EQ(rig.taken.ended.size(), 1U);
  rig.head.request_scan();
  rig.run(4.0);
  ASSERT_EQ(rig.taken.begun.size(), 2U);
  for (int i = 0; i < 3; ++i) {
    rig.head.request_scan();
  }
  EXPECT_EQ(rig.head.scheduler().count(SchedulerEvent::RequestsJoined), 2U);
  rig.run(120.0);
  EXPECT_EQ(rig.taken.ended.size(), 3U);
}

TEST(Requests, AScanThatFailedIsMadeAgain) {
  HeadRig rig(in_mode(ScanMode::Single), kUnit, kRange, posts);
  rig.head.request_scan();
  rig.run(60.0, 1);
  rig.head.request_scan();
  rig.run(4.0);
  rig.unit.device_state = hal::DeviceState::Absent;
  rig.run(1.0);
  rig.unit.device_state = hal::DeviceState::Ready;
  rig.run(120.0);
  EXPECT_EQ(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
}

TEST(Requests, OutliveAHold) {
  HeadRig rig(in_mode(ScanMode::Single), kUnit, kRange, posts);
  rig.head.hold(HoldReason::InterlockOpen);
  rig.head.request_scan();
  rig.run(30.0);
  EXPECT_TRUE(rig.taken.begun.empty());
  rig.head.release(HoldReason::InterlockOpen);
  rig.run(60.0);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
}

TEST(Requests, AbortedOnCommandTheyAreForgotten) {
  HeadRig rig(in_mode(ScanMode::Single), kUnit, kRange, posts);
  rig.head.request_scan();
  rig.run(60.0, 1);
  rig.head.request_scan();
  rig.run(4.0);
  rig.head.request_scan();
  rig.head.abort_scan();
  rig.run(60.0);
  ASSERT_EQ(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::Cancelled);
  EXPECT_EQ(rig.taken.begun.size(), 2U);
  EXPECT_FALSE(rig.head.scheduler().is_requested());
  rig.head.abort_scan();
  rig.run(1.0);
  EXPECT_EQ(rig.taken.aborted.size(), 1U) << "nothing was under way";
  rig.head.request_scan();
  rig.run(60.0);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
}

TEST(Modes, ContinuousGoesOnAfterAnAbortOnCommand) {
  HeadRig rig = scanning_rig();
  run_into_second_scan(rig);
  rig.head.abort_scan();
  rig.run(60.0, 2);
  EXPECT_EQ(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
}

TEST(Modes, AreSwitchedWhileItRuns) {
  HeadRig rig = scanning_rig();
  run_into_second_scan(rig);
  rig.head.set_mode(ScanMode::Single);
  rig.run(60.0);
  EXPECT_EQ(rig.taken.ended.size(), 2U) << "the scan under way is finished";
  EXPECT_EQ(rig.taken.begun.size(), 2U);
  rig.head.set_mode(ScanMode::Continuous);
  rig.run(60.0, 4);
  EXPECT_EQ(rig.taken.ended.size(), 4U);
  EXPECT_TRUE(rig.taken.aborted.empty());
}

TEST(Modes, OneShotMakesOneScanByItself) {
  HeadRig rig(in_mode(ScanMode::OneShot), kUnit, kRange, posts);
  rig.run(120.0);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
  rig.head.request_scan();
  rig.run(60.0);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
}

TEST(PushedHead, TheScanIsEndedAndBegunAgain) {
  HeadRig rig = scanning_rig();
  run_into_second_scan(rig);
  const hal::AxisDynamics dynamics = rig.unit.info().tilt.dynamics;
  rig.unit.tilt.begin(rig.unit.tilt.true_rad(rig.now) + 5 * kPaperStep_rad, 0.2, dynamics, rig.now);
  rig.run(1.0);
  ASSERT_EQ(rig.taken.aborted.size(), 1U) << "a resting axis is polled twice a second";
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::HeadMoved);
  EXPECT_EQ(rig.head.last_abort(), ScanAbort::HeadMoved);
  rig.run(60.0, 2);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
  EXPECT_EQ(rig.taken.ended[1].lines_rejected, 0U);
  EXPECT_EQ(rig.taken.problem_with_order(), nullptr);
}

TEST(ScanAbort, EachHasANameAndACounter) {
  HeadRig rig = scanning_rig();
  for (std::size_t i = 0; i < kScanAborts; ++i) {
    const std::size_t counter = static_cast<std::size_t>(SchedulerEvent::AbortedPanTiltLost) + i;
    EXPECT_EQ(rig.head.scheduler().counters()[counter].name,
              "scans_aborted_" + std::string(kScanAbortNames[i]));
  }
}

}  // namespace
}  // namespace slamsensor::firmware
