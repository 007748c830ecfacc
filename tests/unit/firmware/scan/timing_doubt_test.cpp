// Scans whose timing is in doubt are none, whichever device it is, and scanning goes on when it is over.

#include "firmware/scan/sensor_head.hpp"
#include "tests/unit/firmware/scan/head_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace slamsensor::firmware {
namespace {

constexpr tests::FakePanTiltConfig kUnit{.latency_s = 0.006, .jitter_s = 0.001, .slowness = 1e-4};
constexpr tests::FakeRangefinderConfig kRange{.latency_s = 0.002};

/// Seven lines, so that a change in the middle of a scan has lines on both sides.
SensorHeadConfig seven_lines() {
  SensorHeadConfig config = short_scan();
  config.scan.tilt_min_rad = -30 * kPaperStep_rad;
  config.scan.tilt_max_rad = 30 * kPaperStep_rad;
  config.scan.calibration_lines = 4;
  return config;
}

class TimingDoubt : public testing::Test {
 protected:
  HeadRig rig{seven_lines(), kUnit, kRange, posts};

  /// Until a scan has ended; how many were given up for their timing meanwhile.
  std::size_t doubted_until_scan(double limit_s = 600.0) {
    const std::size_t before = rig.taken.aborted.size();
    rig.run(limit_s, rig.taken.ended.size() + 1);
    return static_cast<std::size_t>(std::count_if(
        rig.taken.aborted.begin() + static_cast<std::ptrdiff_t>(before), rig.taken.aborted.end(),
        [](const ScanAborted& scan) { return scan.reason == ScanAbort::TimingInDoubt; }));
  }

  void run_into_line(std::uint32_t line) {
    const ScanScheduler& scheduler = rig.head.scheduler();
    const auto is_there = [&] {
      return scheduler.pass() == ScanPass::Scan && scheduler.line() == line &&
             scheduler.state() == SchedulerState::Sweeping;
    };
    for (int i = 0; i < 10000 && !is_there(); ++i) {
      rig.run(0.01);
    }
    ASSERT_TRUE(is_there());
  }
};

TEST_F(TimingDoubt, SoundScansAreNotDoubted) {
  rig.run(600.0, 5);
  EXPECT_EQ(rig.taken.ended.size(), 5U);
  EXPECT_TRUE(rig.taken.aborted.empty());
  EXPECT_TRUE(rig.head.problem().empty());
}

TEST_F(TimingDoubt, DoubtOfADeviceEndsTheScanAndNoneBeginsUntilItIsOver) {
  rig.run(600.0, 2);
  rig.run(3.0);
  rig.rangefinder.doubt = "readings come at 4750 Hz instead of 5000 Hz";
  rig.run(60.0);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
  ASSERT_EQ(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::TimingInDoubt);
  EXPECT_TRUE(rig.head.is_timing_in_doubt());
  EXPECT_EQ(rig.head.problem(), rig.rangefinder.doubt);
  EXPECT_EQ(rig.head.scheduler().count(SchedulerEvent::AbortedTimingInDoubt), 1U);
  rig.rangefinder.doubt = {};
  EXPECT_EQ(doubted_until_scan(), 0U);
  EXPECT_EQ(rig.taken.ended.size(), 3U);
  EXPECT_TRUE(rig.head.problem().empty());
}

TEST_F(TimingDoubt, PositionsThatComeLaterGiveNoScanUntilTheLatencyIsFoundAnew) {
  rig.run(600.0, 2);
  const double before_s = rig.head.latency().latency_s;
  rig.unit.held_up_s = 0.025;  // half of the replies' 50 ms
  rig.run(30.0);
  ASSERT_FALSE(rig.taken.aborted.empty());
  EXPECT_EQ(rig.head.doubt(), ScanDoubt::PositionsLoose);
  EXPECT_EQ(rig.head.problem(), describe(ScanDoubt::PositionsLoose));
  const std::size_t doubted = doubted_until_scan();
  EXPECT_LE(doubted, 3U);
  EXPECT_NEAR(rig.head.latency().latency_s, before_s + 0.025, 1e-3);
  for (auto line = rig.taken.lines.end() - 7; line != rig.taken.lines.end(); ++line) {
    EXPECT_NEAR(line->latency_s, before_s + 0.025, 1e-3);
  }
}

TEST_F(TimingDoubt, PositionsThatComeLaterInTheMiddleOfAScanGiveNoScan) {
  for (const std::uint32_t line : {1U, 3U, 4U}) {
    rig.unit.held_up_s = 0.0;
    rig.run(600.0, rig.taken.ended.size() + 1);
    const std::size_t aborted = rig.taken.aborted.size();
    const std::size_t ended = rig.taken.ended.size();
    run_into_line(line);
    rig.unit.held_up_s = 0.025;
    rig.run(600.0, ended + 1);
    ASSERT_GT(rig.taken.aborted.size(), aborted) << "line " << line;
    EXPECT_EQ(rig.taken.aborted[aborted].reason, ScanAbort::TimingInDoubt) << "line " << line;
  }
}

TEST_F(TimingDoubt, AnotherLatencyOfTheRangefinderGivesNoScanUntilItIsFound) {
  rig.run(600.0, 2);
  const double before_s = rig.head.latency().latency_s;
  rig.rangefinder.held_up_s = 0.02;
  EXPECT_EQ(doubted_until_scan(), 3U);
  EXPECT_EQ(rig.taken.aborted.size(), 3U);
  EXPECT_EQ(rig.taken.ended.size(), 3U);
  EXPECT_NEAR(rig.head.latency().latency_s, before_s - 0.02, 1e-3);
  EXPECT_TRUE(rig.head.problem().empty());
}

TEST_F(TimingDoubt, ALatencyThatNobodyMeasuredIsTooLooseForAFastSweep) {
  SensorHeadConfig config = seven_lines();
  config.scan.calibration_lines = 0;
  HeadRig own(config, kUnit, kRange, posts);
  own.run(600.0, 1);
  ASSERT_EQ(own.taken.aborted.size(), 1U) << "known to 20 ms, which is 1 deg";
  EXPECT_EQ(own.taken.aborted[0].reason, ScanAbort::TimingInDoubt);
  EXPECT_EQ(own.taken.ended.size(), 1U) << "the first scan has found it";
}

TEST(TimingWithoutCalibration, WiderPollsThanTheNarrowestAreLoose) {
  SensorHeadConfig config = seven_lines();
  config.scan.calibration_lines = 0;
  config.latency.self_calibration = false;
  config.latency.initial_s = 0.0035;
  HeadRig own(config, kUnit, kRange, posts);
  own.run(600.0, 2);
  EXPECT_TRUE(own.taken.aborted.empty());
  own.unit.held_up_s = 0.025;
  own.run(100.0);
  EXPECT_EQ(own.taken.ended.size(), 2U);
  ASSERT_GE(own.taken.aborted.size(), 1U);
  EXPECT_EQ(own.taken.aborted[0].reason, ScanAbort::TimingInDoubt);
  own.unit.held_up_s = 0.0;
  own.run(200.0, 3);
  EXPECT_EQ(own.taken.ended.size(), 3U);
}

}  // namespace
}  // namespace slamsensor::firmware
