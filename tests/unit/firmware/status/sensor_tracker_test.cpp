#include "firmware/status/sensor_tracker.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace slamsensor::firmware {
namespace {

using core::FixReason;
using core::FixStatus;
using std::chrono::seconds;

HeadStatus head_of(hal::DeviceState pan_tilt, hal::DeviceState rangefinder) {
  HeadStatus head;
  head.pan_tilt.state = pan_tilt;
  head.rangefinder.state = rangefinder;
  return head;
}

HeadStatus ready_head() {
  return head_of(hal::DeviceState::Ready, hal::DeviceState::Ready);
}

core::Fix fix_of(FixStatus status, FixReason reason) {
  core::Fix fix;
  fix.status = status;
  fix.reason = reason;
  fix.pose_W.x_m = 3.0;
  return fix;
}

core::Fix good_fix() {
  return fix_of(FixStatus::Fix, FixReason::None);
}

class SensorTrackerTest : public testing::Test {
 protected:
  /// State and report always agree.
  void expect(SensorState state, FixStatus status, FixReason reason, hal::Stamp now) {
    EXPECT_EQ(tracker_.state(now), state);
    const FixReport report = tracker_.report(now);
    EXPECT_EQ(report.fix.status, status);
    EXPECT_EQ(report.fix.reason, reason);
    EXPECT_EQ(report.fix.status == FixStatus::Fix, state == SensorState::Fixed);
  }

  SensorTracker tracker_{FixConfig{.stale_s = 60.0}, SourceMode::Live, 7, seconds(100)};
};

TEST_F(SensorTrackerTest, StartsUntilAllDevicesHaveAnswered) {
  expect(SensorState::Starting, FixStatus::NoFix, FixReason::Device, seconds(101));
  tracker_.on_head(head_of(hal::DeviceState::Ready, hal::DeviceState::Starting));
  expect(SensorState::Starting, FixStatus::NoFix, FixReason::Device, seconds(102));
  tracker_.on_head(ready_head());
  expect(SensorState::Scanning, FixStatus::NoFix, FixReason::NoScan, seconds(103));
  // In one-shot mode without a trigger it stays so, and nothing gets old that never was.
  expect(SensorState::Scanning, FixStatus::NoFix, FixReason::NoScan, seconds(1000));
}

TEST_F(SensorTrackerTest, AnInclinometerIsADeviceLikeTheOthers) {
  HeadStatus head = ready_head();
  head.inclinometer.emplace().state = hal::DeviceState::Starting;
  tracker_.on_head(head);
  expect(SensorState::Starting, FixStatus::NoFix, FixReason::Device, seconds(101));
  head.inclinometer->state = hal::DeviceState::Ready;
  tracker_.on_head(head);
  tracker_.on_fix(good_fix(), seconds(102));
  expect(SensorState::Fixed, FixStatus::Fix, FixReason::None, seconds(103));
  head.inclinometer->state = hal::DeviceState::Faulted;
  tracker_.on_head(head);
  expect(SensorState::Faulted, FixStatus::NoFix, FixReason::Device, seconds(104));
}

TEST_F(SensorTrackerTest, SaysWhatTheLastScanSaid) {
  tracker_.on_head(ready_head());
  tracker_.on_fix(good_fix(), seconds(110));
  expect(SensorState::Fixed, FixStatus::Fix, FixReason::None, seconds(111));
  tracker_.on_fix(fix_of(FixStatus::Ambiguous, FixReason::Symmetric), seconds(112));
  expect(SensorState::Ambiguous, FixStatus::Ambiguous, FixReason::Symmetric, seconds(113));
  tracker_.on_fix(fix_of(FixStatus::NoFix, FixReason::NoOverlap), seconds(114));
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::NoOverlap, seconds(115));
  tracker_.on_fix(fix_of(FixStatus::NoFix, FixReason::Moved), seconds(116));
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::Moved, seconds(117));
}

TEST_F(SensorTrackerTest, AFixGrowsStale) {
  tracker_.on_head(ready_head());
  tracker_.on_fix(good_fix(), seconds(110));
  expect(SensorState::Fixed, FixStatus::Fix, FixReason::None, seconds(170));
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::Stale, seconds(171));
}

TEST_F(SensorTrackerTest, ALostDeviceTakesTheFixAwayUntilTheNextScan) {
  tracker_.on_head(ready_head());
  tracker_.on_fix(good_fix(), seconds(110));
  tracker_.on_head(head_of(hal::DeviceState::Absent, hal::DeviceState::Ready));
  expect(SensorState::Faulted, FixStatus::NoFix, FixReason::Device, seconds(111));
  tracker_.on_head(ready_head());
  expect(SensorState::Scanning, FixStatus::NoFix, FixReason::NoScan, seconds(112));
  tracker_.on_fix(good_fix(), seconds(113));
  expect(SensorState::Fixed, FixStatus::Fix, FixReason::None, seconds(114));
}

TEST_F(SensorTrackerTest, HeldIsNoFix) {
  tracker_.on_head(ready_head());
  tracker_.on_fix(good_fix(), seconds(110));
  HeadStatus held = ready_head();
  held.held = true;
  tracker_.on_head(held);
  expect(SensorState::Held, FixStatus::NoFix, FixReason::Device, seconds(111));
  tracker_.on_head(ready_head());
  expect(SensorState::Scanning, FixStatus::NoFix, FixReason::NoScan, seconds(112));
}

TEST_F(SensorTrackerTest, AHeadThatMakesNoScansIsFaultedThoughItsDevicesAnswer) {
  HeadStatus failing = ready_head();
  failing.failing = true;
  tracker_.on_head(failing);
  expect(SensorState::Faulted, FixStatus::NoFix, FixReason::Device, seconds(105));
  tracker_.on_head(ready_head());
  expect(SensorState::Scanning, FixStatus::NoFix, FixReason::NoScan, seconds(106));
  tracker_.on_fix(good_fix(), seconds(110));
  tracker_.on_head(failing);
  expect(SensorState::Faulted, FixStatus::NoFix, FixReason::Device, seconds(111));
  failing.held = true;
  tracker_.on_head(failing);
  expect(SensorState::Held, FixStatus::NoFix, FixReason::Device, seconds(112));
  tracker_.on_head(ready_head());
  expect(SensorState::Scanning, FixStatus::NoFix, FixReason::NoScan, seconds(113));
  tracker_.on_fix(good_fix(), seconds(114));
  expect(SensorState::Fixed, FixStatus::Fix, FixReason::None, seconds(115));
}

TEST_F(SensorTrackerTest, TimingInDoubtIsNoFixHoweverLong) {
  HeadStatus doubtful = ready_head();
  doubtful.timing_in_doubt = true;
  tracker_.on_head(doubtful);
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::Timing, seconds(105));
  tracker_.on_head(ready_head());
  tracker_.on_fix(good_fix(), seconds(110));
  tracker_.on_head(doubtful);
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::Timing, seconds(111));
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::Timing, seconds(500));
  tracker_.on_head(ready_head());
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::Timing, seconds(112));
  tracker_.on_fix(good_fix(), seconds(114));
  expect(SensorState::Fixed, FixStatus::Fix, FixReason::None, seconds(115));
}

TEST_F(SensorTrackerTest, AnotherMapMakesTheFixVoid) {
  tracker_.on_head(ready_head());
  tracker_.on_fix(good_fix(), seconds(110));
  tracker_.on_new_map();
  expect(SensorState::Scanning, FixStatus::NoFix, FixReason::NoScan, seconds(111));
  tracker_.on_fix(fix_of(FixStatus::NoFix, FixReason::NoOverlap), seconds(112));
  expect(SensorState::Lost, FixStatus::NoFix, FixReason::NoOverlap, seconds(112));
}

TEST_F(SensorTrackerTest, TimeToFirstFixIsThatOfTheFirst) {
  tracker_.on_head(ready_head());
  tracker_.on_fix(fix_of(FixStatus::NoFix, FixReason::TooFewLandmarks), seconds(110));
  EXPECT_FALSE(tracker_.report(seconds(111)).time_to_first_fix);
  tracker_.on_fix(good_fix(), seconds(120));
  tracker_.on_fix(good_fix(), seconds(130));
  const FixReport report = tracker_.report(seconds(131));
  EXPECT_EQ(report.time_to_first_fix, seconds(20));
  EXPECT_EQ(report.uptime, seconds(31));
  EXPECT_EQ(report.initialization, 7U);
}

}  // namespace
}  // namespace slamsensor::firmware
