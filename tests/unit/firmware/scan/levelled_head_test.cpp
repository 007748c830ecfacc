// A head that leans: its readings come out level, it does not scan while its lean is unknown or too large,
// and a lean that changes during a scan is a carrier that moved.

#include "core/detection/levelling.hpp"
#include "firmware/recording/recording_links.hpp"
#include "tests/unit/firmware/scan/head_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slamsensor::firmware {
namespace {

using core::kDegree;

constexpr tests::FakePanTiltConfig kUnit{.latency_s = 0.006, .jitter_s = 0.001, .slowness = 1e-4};
constexpr tests::FakeRangefinderConfig kRange{.latency_s = 0.002};

SensorHeadConfig with_source(InclinationSource source) {
  SensorHeadConfig config = short_scan();
  config.levelling.source = source;
  return config;
}

HeadRig rig_of(const SensorHeadConfig& config) {
  return HeadRig(config, kUnit, kRange, posts);
}

void expect_levelled(const std::vector<std::vector<core::Reading>>& got,
                     const std::vector<std::vector<core::Reading>>& own, const core::Attitude& attitude) {
  const core::Levelling level(attitude);
  ASSERT_EQ(got.size(), own.size());
  for (std::size_t line = 0; line < own.size(); ++line) {
    ASSERT_EQ(got[line].size(), own[line].size());
    for (std::size_t i = 0; i < own[line].size(); ++i) {
      const core::Reading expected = level(own[line][i]);
      ASSERT_EQ(got[line][i].pan_rad, expected.pan_rad);
      ASSERT_EQ(got[line][i].tilt_rad, expected.tilt_rad);
      ASSERT_EQ(got[line][i].range_m, expected.range_m);
    }
  }
}

TEST(LevelledHead, FixedAttitudeTurnsTheReadings) {
  SensorHeadConfig config = with_source(InclinationSource::Fixed);
  config.levelling.fixed = {3.0 * kDegree, -4.0 * kDegree};
  HeadRig leaning = rig_of(config);
  HeadRig upright = rig_of(short_scan());
  leaning.run(60.0, 1);
  upright.run(60.0, 1);
  ASSERT_EQ(leaning.taken.ended.size(), 1U);
  expect_levelled(leaning.taken.readings, upright.taken.readings, config.levelling.fixed);
  EXPECT_EQ(leaning.head.latency().latency_s, upright.head.latency().latency_s)
      << "the latency is found from the head's own angles";
  EXPECT_FALSE(upright.head.attitude());
}

TEST(LevelledHead, WaitsForTheInclinometer) {
  SensorHeadConfig config = with_source(InclinationSource::Can);
  config.levelling.offset = {1.0 * kDegree, 0.0};
  HeadRig rig = rig_of(config);
  rig.run(60.0, 1);
  EXPECT_TRUE(rig.taken.begun.empty());
  EXPECT_EQ(rig.head.problem(), describe(HoldReason::LeanUnknown));
  EXPECT_FALSE(rig.head.attitude());
  rig.head.incline({4.0 * kDegree, 2.0 * kDegree});
  rig.run(60.0, 1);
  ASSERT_EQ(rig.taken.ended.size(), 1U);
  HeadRig upright = rig_of(short_scan());
  upright.run(60.0, 1);
  ASSERT_EQ(rig.taken.readings.size(), upright.taken.readings.size());
  const auto attitude = rig.head.attitude();
  ASSERT_TRUE(attitude);
  EXPECT_NEAR(attitude->roll_rad, 3.0 * kDegree, 1e-3);
  EXPECT_NEAR(attitude->pitch_rad, 2.0 * kDegree, 1e-3);
}

TEST(LevelledHead, StopsWhenTheInclinometerFallsSilent) {
  HeadRig rig = rig_of(with_source(InclinationSource::Iio));
  rig.head.incline({});
  rig.run(60.0, 1);
  rig.run(2.0);
  rig.head.hold(HoldReason::LeanUnknown);
  rig.run(20.0);
  ASSERT_EQ(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::Held);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
  rig.head.incline({});
  rig.run(60.0, 2);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
}

TEST(LevelledHead, DoesNotScanWhileItLeansTooFar) {
  SensorHeadConfig config = with_source(InclinationSource::Can);
  config.levelling.max_lean_rad = 5.0 * kDegree;
  HeadRig rig = rig_of(config);
  rig.head.incline({4.0 * kDegree, 4.0 * kDegree});  // 5.7 deg
  rig.run(60.0);
  EXPECT_TRUE(rig.taken.begun.empty());
  EXPECT_EQ(rig.head.problem(), describe(HoldReason::LeansTooFar));
  rig.head.incline({4.0 * kDegree, 0.0});
  rig.run(60.0, 1);
  EXPECT_EQ(rig.taken.ended.size(), 1U);
}

TEST(LevelledHead, LeanThatChangesDuringAScanIsACarrierThatMoved) {
  HeadRig rig = rig_of(with_source(InclinationSource::Can));
  rig.head.incline({0.0, 1.0 * kDegree});
  rig.run(60.0, 1);
  rig.run(3.0);
  ASSERT_EQ(rig.taken.begun.size(), 2U);
  rig.head.incline({0.5 * kDegree, 1.0 * kDegree});
  rig.run(0.01);
  EXPECT_TRUE(rig.taken.aborted.empty()) << "noise of the inclinometer";
  rig.head.incline({1.2 * kDegree, 1.0 * kDegree});
  rig.run(0.01);
  ASSERT_EQ(rig.taken.aborted.size(), 1U);
  EXPECT_EQ(rig.taken.aborted[0].reason, ScanAbort::CarrierMoved);
  rig.run(60.0, 2);
  EXPECT_EQ(rig.taken.ended.size(), 2U) << "the next one begins with the new attitude";
  EXPECT_EQ(rig.taken.aborted.size(), 1U);
}

TEST(LevelledHead, LeanMayChangeBetweenScans) {
  SensorHeadConfig config = with_source(InclinationSource::Can);
  config.scan.mode = ScanMode::OneShot;
  HeadRig rig = rig_of(config);
  rig.head.incline({});
  rig.head.request_scan();
  rig.run(60.0, 1);
  rig.run(10.0);
  rig.head.incline({5.0 * kDegree, 0.0});
  rig.head.request_scan();
  rig.run(60.0, 2);
  EXPECT_EQ(rig.taken.ended.size(), 2U);
  EXPECT_TRUE(rig.taken.aborted.empty());
}

TEST(LevelledHead, PassesOverWhatIsNoAttitudeOrNotAskedFor) {
  HeadRig rig = rig_of(with_source(InclinationSource::Can));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  rig.head.incline({nan, 0.0});
  rig.head.incline({0.0, std::numeric_limits<double>::infinity()});
  EXPECT_FALSE(rig.head.attitude());
  HeadRig none = rig_of(short_scan());
  none.head.incline({0.1, 0.1});
  EXPECT_FALSE(none.head.attitude());
}

TEST(LevelledHead, TakesTheAttitudeFromATape) {
  HeadRig rig = rig_of(with_source(InclinationSource::Can));
  command(rig.head, TapeCommand::Incline, pack_inclination(-3.25 * kDegree, 1.5 * kDegree));
  const auto attitude = rig.head.attitude();
  ASSERT_TRUE(attitude);
  EXPECT_NEAR(attitude->roll_rad, -3.25 * kDegree, 1e-7);
  EXPECT_NEAR(attitude->pitch_rad, 1.5 * kDegree, 1e-7);
}

}  // namespace
}  // namespace slamsensor::firmware
