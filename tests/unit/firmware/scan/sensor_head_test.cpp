#include "firmware/scan/sensor_head.hpp"

#include "tests/unit/firmware/scan/head_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace slamsensor::firmware {
namespace {

constexpr tests::FakePanTiltConfig kUnit{.latency_s = 0.006, .jitter_s = 0.001, .slowness = 1e-4};
constexpr tests::FakeRangefinderConfig kRange{.latency_s = 0.002};

TEST(SensorHead, SweepsBackAndForthFromTheLowestTiltUp) {
  HeadRig rig(short_scan(), kUnit, kRange, posts);
  rig.run(60.0, 2);
  ASSERT_EQ(rig.taken.ended.size(), 2U);
  ASSERT_EQ(rig.taken.lines.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const Scanline& line = rig.taken.lines[i];
    EXPECT_EQ(line.line, i % 3);
    EXPECT_NEAR(line.tilt_rad, (static_cast<double>(i % 3) - 1.0) * 10 * kPaperStep_rad, 1e-9);
    EXPECT_NEAR(static_cast<double>(rig.taken.readings[i].size()), 2400.0, 3.0);
    const bool grows = rig.taken.readings[i].front().pan_rad < rig.taken.readings[i].back().pan_rad;
    EXPECT_EQ(grows, line.direction == SweepDirection::Leftwards);
    if (i > 0) {
      EXPECT_NE(line.direction, rig.taken.lines[i - 1].direction) << i;
    }
  }
  const ScanEnded& first = rig.taken.ended[0];
  EXPECT_EQ(first.scan, 0U);
  EXPECT_EQ(first.lines, 3U);
  EXPECT_LT(first.begin, first.middle);
  EXPECT_EQ((first.middle - first.begin) / 1000, (first.end - first.middle) / 1000);
  EXPECT_LT(first.end, rig.taken.ended[1].begin);
  EXPECT_EQ(rig.head.scheduler().count(SchedulerEvent::CalibrationsFinished), 1U);
  EXPECT_EQ(rig.head.events_dropped(), 0U);
}

TEST(SensorHead, TheFirstScanAlreadyKnowsTheLatency) {
  HeadRig rig(short_scan(), kUnit, kRange, posts);
  rig.run(60.0, 1);
  ASSERT_EQ(rig.taken.lines.size(), 3U);
  EXPECT_NEAR(rig.taken.lines[0].latency_s, 0.0035, 2e-4);
  EXPECT_EQ(rig.head.latency().pairs, 1U);
  EXPECT_LT(rig.taken.lines[0].pan_sigma_rad, 0.5 * kPaperStep_rad);
}

TEST(SensorHead, EqualInputsGiveEqualScans) {
  HeadRig a(short_scan(), kUnit, kRange, posts);
  HeadRig b(short_scan(), kUnit, kRange, posts);
  a.run(60.0, 1);
  b.run(60.0, 1);
  ASSERT_EQ(a.taken.readings.size(), b.taken.readings.size());
  for (std::size_t i = 0; i < a.taken.readings.size(); ++i) {
    EXPECT_TRUE(
        std::ranges::equal(a.taken.readings[i], b.taken.readings[i], [](const auto& p, const auto& q) {
          return p.pan_rad == q.pan_rad && p.tilt_rad == q.tilt_rad && p.range_m == q.range_m;
        }));
  }
}

TEST(SensorHead, SingleScansAreMadeOnRequest) {
  SensorHeadConfig config = short_scan();
  config.scan.mode = ScanMode::Single;
  HeadRig rig(config, kUnit, kRange, posts);
  rig.run(5.0);
  EXPECT_TRUE(rig.taken.begun.empty());
  rig.head.request_scan();
  rig.run(60.0);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
  rig.head.request_scan();
  rig.run(30.0);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
  EXPECT_EQ(rig.taken.begun.size(), 2U);
}

TEST(SensorHead, ALostDeviceAbortsTheScanAndItIsBegunAgain) {
  for (const bool pan_tilt : {true, false}) {
    HeadRig rig(short_scan(), kUnit, kRange, posts);
    hal::DeviceState& state = pan_tilt ? rig.unit.device_state : rig.rangefinder.device_state;
    rig.run(60.0, 1);
    rig.run(4.0);
    state = hal::DeviceState::Absent;
    rig.run(3.0);
    ASSERT_EQ(rig.taken.aborted.size(), 1U);
    EXPECT_EQ(rig.taken.aborted[0].scan, 1U);
    EXPECT_EQ(rig.taken.aborted[0].reason, pan_tilt ? ScanAbort::PanTiltLost : ScanAbort::RangefinderLost);
    EXPECT_EQ(rig.head.problem(), pan_tilt ? "fake unit is not ready" : "fake rangefinder is not ready");
    EXPECT_EQ(rig.head.last_abort(), rig.taken.aborted[0].reason);
    state = hal::DeviceState::Ready;
    rig.run(30.0, 2);
    EXPECT_EQ(rig.taken.ended.size(), 2U);
    EXPECT_EQ(rig.taken.problem_with_order(), nullptr);
    EXPECT_TRUE(rig.head.problem().empty());
  }
}

TEST(SensorHead, AStallAbortsTheScan) {
  HeadRig rig(short_scan(), kUnit, kRange, posts);
  rig.run(60.0, 1);
  rig.unit.pan.stall_rad = 0.1;
  rig.unit.pan.stall_s = std::numeric_limits<double>::infinity();
  rig.run(30.0);
  ASSERT_GE(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::PanStalled);
  EXPECT_GE(rig.unit.halts, 1);
  rig.unit.pan.stall_s = 0.0;
  rig.run(60.0, 2);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
}

TEST(SensorHead, ALineWithAnObstacleIsRejectedAndAScanOfThemAborted) {
  SensorHeadConfig config = short_scan();
  config.scan.lines_rejected_max_share = 0.4;
  HeadRig rig(config, kUnit, kRange, posts);
  rig.run(60.0, 1);
  rig.unit.pan.stall_rad = 0.1;
  rig.unit.pan.stall_s = 0.3;  // passes within the margin
  rig.run(20.0);
  EXPECT_EQ(rig.taken.lines.size(), 3U);
  ASSERT_GE(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::LinesRejected);
}

TEST(SensorHead, RefusedMovesAbortTheScan) {
  HeadRig rig(short_scan(), kUnit, kRange, posts);
  rig.run(60.0, 1);
  rig.unit.answer = hal::MoveStatus::OutOfRange;
  rig.run(5.0);
  ASSERT_GE(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::MoveRefused);
  rig.unit.answer = hal::MoveStatus::Busy;
  rig.run(20.0);
  const std::uint64_t stalls = rig.head.scheduler().count(SchedulerEvent::AbortedPanStalled) +
                               rig.head.scheduler().count(SchedulerEvent::AbortedTiltStalled);
  EXPECT_GE(stalls, 1U);
}

TEST(SensorHead, ASilentRangefinderGivesNoLines) {
  HeadRig rig(short_scan(), kUnit, kRange, posts);
  rig.rangefinder.is_silent = true;
  rig.run(60.0);
  EXPECT_TRUE(rig.taken.lines.empty());
  EXPECT_GE(rig.head.assembler().count(core::AssemblerEvent::LinesNoReadings), 2U);
  EXPECT_GE(rig.head.scheduler().count(SchedulerEvent::AbortedLinesRejected), 1U);
}

TEST(SensorHead, AnImpossiblePlanIsReportedAndTriedAgain) {
  HeadRig rig(short_scan(), kUnit, kRange, posts);
  const double reach_rad = rig.unit.info().pan.max_rad;
  rig.unit.info().pan.min_rad = 0.95 * reach_rad;
  rig.run(5.0);
  EXPECT_TRUE(rig.taken.begun.empty());
  EXPECT_GE(rig.head.scheduler().count(SchedulerEvent::PlansRefused), 2U);
  EXPECT_NE(rig.head.problem().find("pan limits"), std::string_view::npos) << rig.head.problem();
  rig.unit.info().pan.min_rad = -reach_rad;
  rig.run(60.0, 1);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
}

TEST(SensorHead, WithoutEdgesItScansOnWithTheConfiguredLatency) {
  SensorHeadConfig config = short_scan();
  config.latency.initial_s = 0.003;
  config.latency.initial_sigma_s = 0.002;
  HeadRig rig(config, kUnit, kRange, plain);
  rig.run(60.0, 1);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
  EXPECT_EQ(rig.taken.lines.at(0).latency_s, 0.003);
  EXPECT_EQ(rig.head.latency().pairs, 0U);
  EXPECT_EQ(rig.head.calibration().count(core::LatencyEvent::PairsNoEdges),
            2U);  // that of the last line is under way
  EXPECT_EQ(rig.head.calibration().count(core::LatencyEvent::PassesRefused), 1U);
}

TEST(SensorHead, WithoutEdgesALatencyConfiguredTooLooselyGivesNoScan) {
  HeadRig rig(short_scan(), kUnit, kRange, plain);  // known to 20 ms: 1 deg of pan
  rig.run(60.0);
  EXPECT_TRUE(rig.taken.ended.empty());
  ASSERT_GE(rig.taken.aborted.size(), 2U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::TimingInDoubt);
  EXPECT_EQ(rig.head.problem(), describe(ScanDoubt::LatencyUnknown));
}

TEST(SensorHead, WithoutRampsOrWithThemTheReadingsAreWhereTheyWereMade) {
  SensorHeadConfig config = short_scan();
  config.scan.pan_speed_radps = 2000 * kPaperStep_rad;  // above the base speed
  HeadRig rig(config, kUnit, {.rate_hz = 4000.0, .latency_s = 0.002}, posts);
  std::size_t readings = 0;
  double worst_rad = 0.0;
  while (readings < 10'000 && rig.now < std::chrono::seconds(60)) {
    rig.now += std::chrono::milliseconds(1);
    rig.head.step(rig.now);
    while (const auto event = rig.head.take()) {
      const auto* const line = std::get_if<Scanline>(&*event);
      for (std::size_t i = 0; line != nullptr && i < line->readings.size(); ++i, ++readings) {
        const double off_rad = line->readings[i].pan_rad - rig.rangefinder.true_pan_rad(line->stamps[i]);
        worst_rad = std::max(worst_rad, std::abs(off_rad));
      }
    }
  }
  EXPECT_GE(readings, 10'000U);
  EXPECT_LT(worst_rad, 1.5 * kPaperStep_rad);  // 0.75 ms at this speed
}

}  // namespace
}  // namespace slamsensor::firmware
