#include "tests/unit/hal/pantilt/ptu_bench.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>

namespace slamsensor::tests {
namespace {

using hal::Axis;
using hal::DeviceState;
using hal::MoveStatus;
using hal::Stamp;
using std::chrono::milliseconds;
using std::chrono::seconds;

class PtuMotion : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until_ready()); }

  PtuBench bench;
};

TEST_F(PtuMotion, SweepsAtConstantSpeedAndReportsWhereItWas) {
  const auto samples = bench.sweep(Axis::Pan, 2500, 1000);
  EXPECT_NEAR(static_cast<double>(samples.size()), 2.5 * 40.0, 6.0);
  expect_true(samples, bench.unit, bench.rad(1));
  for (const hal::AxisSample& sample : samples) {
    EXPECT_LE(sample.half_width, milliseconds(3));
    EXPECT_GT(sample.half_width, milliseconds(1));
  }
  EXPECT_NEAR(bench.driver->axis(Axis::Pan).position_rad, bench.rad(2500), 1e-12);
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_EQ(bench.counter("positions_implausible"), 0U);
  EXPECT_EQ(bench.counter("resyncs"), 0U);
}

TEST_F(PtuMotion, TheProfileIsTheMoveThatTheUnitMakes) {
  ASSERT_EQ(bench.driver->move(Axis::Pan, bench.rad(2000), bench.rad(1000)), MoveStatus::Accepted);
  EXPECT_EQ(bench.driver->move(Axis::Pan, 0.0, bench.rad(1000)), MoveStatus::Busy);
  ASSERT_TRUE(bench.run(seconds(1), [&] { return bench.driver->axis(Axis::Pan).moving; }));
  const hal::AxisStatus& status = bench.driver->axis(Axis::Pan);
  for (int i = 1; i < 19; ++i) {
    const Stamp at = status.begun + milliseconds(100 * i);
    EXPECT_NEAR(status.move.position_rad(0.1 * i), bench.rad(bench.unit.position('P', at)), bench.rad(3));
  }
}

TEST_F(PtuMotion, SetsTheSpeedOnlyWhenItDiffers) {
  bench.sweep(Axis::Pan, 500, 1000);
  bench.sweep(Axis::Pan, -500, 1000);
  bench.sweep(Axis::Pan, 0, 900);
  EXPECT_EQ(bench.unit.count("PS1000"), 1);
  EXPECT_EQ(bench.unit.count("PS900"), 1);
}

TEST_F(PtuMotion, FollowsATrapezoid) {
  expect_true(bench.sweep(Axis::Pan, 3000, 2500), bench.unit, bench.rad(1));
  expect_true(bench.sweep(Axis::Pan, 2800, 2500), bench.unit, bench.rad(1));
  EXPECT_EQ(bench.counter("positions_implausible"), 0U);
}

TEST_F(PtuMotion, MovesBothAxesAtOnce) {
  ASSERT_EQ(bench.driver->move(Axis::Pan, bench.rad(1500), bench.rad(1000)), MoveStatus::Accepted);
  ASSERT_EQ(bench.driver->move(Axis::Tilt, bench.rad(-700), bench.rad(500)), MoveStatus::Accepted);
  bench.run(seconds(4));
  expect_true(bench.take(), bench.unit, bench.rad(1));
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_FALSE(bench.driver->axis(Axis::Tilt).moving);
  EXPECT_NEAR(bench.driver->axis(Axis::Tilt).position_rad, bench.rad(-700), 1e-12);
  EXPECT_EQ(bench.counter("positions_implausible"), 0U);
}

TEST_F(PtuMotion, ARestingAxisIsPolledSlowly) {
  bench.unit.heard.clear();
  bench.run(seconds(10));
  EXPECT_NEAR(bench.unit.count("PP"), 20, 2);
  EXPECT_NEAR(bench.unit.count("TP"), 20, 2);
  EXPECT_NEAR(static_cast<double>(bench.take().size()), 40.0, 4.0);
}

TEST_F(PtuMotion, KeepsTheOldestPositionsAndCountsTheOthers) {
  bench.run(seconds(100));
  EXPECT_EQ(bench.take().size(), hal::kAxisSamplesMax);
  EXPECT_GT(bench.counter("positions_dropped"), 100U);
}

TEST_F(PtuMotion, RefusesWhatTheUnitCannotDo) {
  const double speed = bench.rad(1000);
  EXPECT_EQ(bench.driver->move(Axis::Pan, bench.rad(3091), speed), MoveStatus::OutOfRange);
  EXPECT_EQ(bench.driver->move(Axis::Tilt, bench.rad(-908), speed), MoveStatus::OutOfRange);
  EXPECT_EQ(bench.driver->move(Axis::Pan, 0.0, bench.rad(2903)), MoveStatus::OutOfRange);
  EXPECT_EQ(bench.driver->move(Axis::Pan, 0.0, bench.rad(30)), MoveStatus::OutOfRange);
  EXPECT_EQ(bench.driver->move(Axis::Pan, std::nan(""), speed), MoveStatus::OutOfRange);
  EXPECT_EQ(bench.driver->move(Axis::Pan, 0.0, -speed), MoveStatus::OutOfRange);
  EXPECT_EQ(bench.driver->move(Axis::Pan, std::numeric_limits<double>::infinity(), speed),
            MoveStatus::OutOfRange);
  EXPECT_EQ(bench.counter("moves_refused"), 7U);
  bench.unit.heard.clear();
  bench.run(seconds(1));
  EXPECT_EQ(bench.unit.count("PS1000"), 0);
}

TEST_F(PtuMotion, ARejectedMoveLeavesTheAxisAsItWas) {
  bench.unit.facts["PX"] = "2000";
  EXPECT_EQ(bench.driver->move(Axis::Pan, bench.rad(2500), bench.rad(1000)), MoveStatus::Accepted);
  bench.run(seconds(1));
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_EQ(bench.driver->axis(Axis::Pan).position_rad, 0.0);
  EXPECT_EQ(bench.counter("moves_rejected"), 1U);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
  expect_true(bench.sweep(Axis::Pan, 1500, 1000), bench.unit, bench.rad(1));
}

TEST_F(PtuMotion, AnAxisErrorLeadsToAReset) {
  bench.unit.mishaps.push_back({"PP300", [](std::string) { return "! Axis Error\r\n"; }, {}});
  EXPECT_EQ(bench.driver->move(Axis::Pan, bench.rad(300), bench.rad(1000)), MoveStatus::Accepted);
  ASSERT_TRUE(bench.run(seconds(1), [&] { return bench.driver->state() == DeviceState::Starting; }));
  EXPECT_THAT(std::string(bench.driver->problem()), testing::HasSubstr("axis error"));
  ASSERT_TRUE(bench.run_until_ready());
  EXPECT_EQ(bench.unit.count("R"), 1);
}

TEST_F(PtuMotion, HaltStopsBothAxesAndReportsWhereTheyStand) {
  ASSERT_EQ(bench.driver->move(Axis::Pan, bench.rad(2500), bench.rad(1000)), MoveStatus::Accepted);
  bench.run(seconds(1));
  ASSERT_EQ(bench.driver->halt(), MoveStatus::Accepted);
  EXPECT_EQ(bench.driver->move(Axis::Pan, 0.0, bench.rad(1000)), MoveStatus::Busy);
  bench.run(seconds(1));
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_NEAR(bench.driver->axis(Axis::Pan).position_rad, bench.rad(bench.unit.position('P', bench.now)),
              1e-12);
  EXPECT_EQ(bench.counter("moves_lost"), 0U);
  expect_true(bench.sweep(Axis::Pan, -100, 1000), bench.unit, bench.rad(1));
}

TEST_F(PtuMotion, AMoveMayReplaceAMove) {
  for (const double speed : {1000.0, 2500.0}) {
    ASSERT_EQ(bench.driver->move(Axis::Pan, bench.rad(2500), bench.rad(1000)), MoveStatus::Accepted);
    bench.run(seconds(1));
    static_cast<void>(bench.take());
    ASSERT_EQ(bench.driver->move(Axis::Pan, bench.rad(-500), bench.rad(speed)), MoveStatus::Accepted);
    bench.run(seconds(5));
    EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
    EXPECT_NEAR(bench.driver->axis(Axis::Pan).position_rad, bench.rad(-500), 1e-12);
    EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
    EXPECT_EQ(bench.counter("restarts"), 0U);
  }
}

TEST_F(PtuMotion, ALongerControllerLatencyOnlyWidensTheStamps) {
  bench.unit.latency = milliseconds(20);
  const auto samples = bench.sweep(Axis::Pan, 2500, 1000);
  EXPECT_GT(samples.size(), 40U);
  expect_true(samples, bench.unit, bench.rad(1));
}

TEST_F(PtuMotion, AMoveThatBeginsLateIsFollowed) {
  bench.unit.move_latency = milliseconds(80);
  const auto samples = bench.sweep(Axis::Pan, 2500, 1000);
  EXPECT_GT(samples.size(), 80U);
  expect_true(samples, bench.unit, bench.rad(1));
  EXPECT_EQ(bench.counter("restarts"), 0U);
}

TEST_F(PtuMotion, SlowStepsOnlyWidenTheStamps) {
  bench.period = milliseconds(10);
  const auto samples = bench.sweep(Axis::Pan, 2500, 1000);
  EXPECT_GT(samples.size(), 40U);
  expect_true(samples, bench.unit, bench.rad(1));
  EXPECT_EQ(bench.counter("resyncs"), 0U);
}

TEST(PtuPolls, PollsFasterAtAFastRate) {
  hal::PtuConfig config;
  config.fast_baud = 115200;
  config.poll_hz = 100.0;
  PtuBench bench(config);
  ASSERT_TRUE(bench.run_until_ready());
  const auto samples = bench.sweep(Axis::Pan, 2500, 1000);
  EXPECT_GT(samples.size(), 230U);
  expect_true(samples, bench.unit, bench.rad(1));
}

TEST(PtuDriver, TheSenseOfAnAxisTurnsEverythingRound) {
  hal::PtuConfig config;
  config.tilt_sense = hal::PtuSense::Reversed;
  PtuBench bench(config);
  ASSERT_TRUE(bench.run_until_ready());
  EXPECT_NEAR(bench.driver->info().tilt.min_rad, bench.rad(-604), 1e-12);
  EXPECT_NEAR(bench.driver->info().tilt.max_rad, bench.rad(907), 1e-12);
  const auto samples = bench.sweep(Axis::Tilt, 800, 1000);
  EXPECT_EQ(bench.unit.position('T', bench.now), -800);
  EXPECT_NEAR(bench.driver->axis(Axis::Tilt).position_rad, bench.rad(800), 1e-12);
  ASSERT_GT(samples.size(), 20U);
  EXPECT_EQ(bench.counter("positions_implausible"), 0U);
}

TEST(PtuDriver, ALineThatGoesDownIsAnAbsentUnitUntilItComesBack) {
  PtuBench bench;
  ASSERT_TRUE(bench.run_until_ready());
  ASSERT_EQ(bench.driver->move(Axis::Pan, bench.rad(2500), bench.rad(1000)), MoveStatus::Accepted);
  bench.run(seconds(1));
  bench.link.set_up(false);
  bench.run(seconds(1));
  EXPECT_EQ(bench.driver->state(), DeviceState::Absent);
  EXPECT_THAT(std::string(bench.driver->problem()), testing::HasSubstr("line is down"));
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_EQ(bench.driver->halt(), MoveStatus::NotReady);
  bench.link.set_up(true);
  ASSERT_TRUE(bench.run_until_ready());
  EXPECT_EQ(bench.counter("restarts"), 1U);
}

TEST(PtuDriver, AFullLineIsTriedAgain) {
  PtuBench bench;
  bench.link.set_full(true);
  bench.run(seconds(5));
  EXPECT_EQ(bench.driver->state(), DeviceState::Starting);
  bench.link.set_full(false);
  ASSERT_TRUE(bench.run_until_ready());
}

TEST(PtuPolls, OfASteadyAxisComeAtEverOtherPlacesBetweenItsPositions) {
  PtuBench bench;
  bench.period = std::chrono::microseconds(100);
  ASSERT_TRUE(bench.run_until_ready());
  const auto samples = bench.sweep(Axis::Pan, 3000, 1000.0);  // a position a millisecond
  ASSERT_GT(samples.size(), 100U);
  std::array<double, 5> fifths{};
  for (std::size_t i = 1; i < samples.size(); ++i) {
    // 20 % either way of 25 ms, and at times a poll of the other axis in between.
    const double apart_s = hal::to_seconds(samples[i].stamp - samples[i - 1].stamp);
    EXPECT_GT(apart_s, 0.015);
    EXPECT_LT(apart_s, 0.045);
    fifths[static_cast<std::size_t>((samples[i].stamp % std::chrono::milliseconds(1)).count() / 200'000)] +=
        1.0 / static_cast<double>(samples.size() - 1);
  }
  for (const double share : fifths) {
    EXPECT_NEAR(share, 0.2, 0.08);
  }
  EXPECT_NEAR(
      hal::to_seconds(samples.back().stamp - samples.front().stamp) / static_cast<double>(samples.size() - 1),
      0.025, 0.0005);
}

}  // namespace
}  // namespace slamsensor::tests
