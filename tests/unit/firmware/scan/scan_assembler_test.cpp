#include "core/sweep/scan_assembler.hpp"

#include "firmware/arena_block.hpp"
#include "firmware/scan/sensor_head.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slamsensor::firmware {
namespace {

using core::AssemblerEvent;
using core::LineRejection;

using std::chrono::milliseconds;

constexpr double kStep_rad = kPaperStep_rad;
constexpr double kTilt_rad = -30 * kStep_rad;
constexpr hal::Stamp kBegun = milliseconds(1000);

constexpr core::AssemblerConfig kSmall = {.readings_per_line_max = 3000, .polls_per_line_max = 200};

/// One second at 1000 positions/s to the left, polled without error, a reading each millisecond.
class ScanAssemblerTest : public ::testing::Test {
 protected:
  ArenaBlock<core::ScanAssembler> block{kSmall, PanFitConfig{}};
  core::ScanAssembler& assembler = *block.operator->();
  hal::MotionProfile move{-500 * kStep_rad, 500 * kStep_rad, 1000 * kStep_rad, {1000 * kStep_rad, 0.0}};
  std::vector<hal::RangeSample> samples;
  std::vector<hal::AxisSample> polls;

  void SetUp() override {
    for (int ms = 500; ms < 2500; ++ms) {
      samples.push_back({milliseconds(ms), 20.0, 0.0, hal::Echo::Return});
    }
    for (int us = 900'000; us < 2'200'000; us += 23'400) {
      const hal::Stamp at = std::chrono::microseconds(us);
      const double pan_rad = move.position_rad(hal::to_seconds(at - kBegun));
      polls.push_back({at, milliseconds(2), std::round(pan_rad / kStep_rad) * kStep_rad, hal::Axis::Pan});
    }
    polls.push_back({milliseconds(1500), milliseconds(2), kTilt_rad + kStep_rad, hal::Axis::Tilt});
  }

  void add_all() {
    for (const hal::RangeSample& sample : samples) {
      assembler.add(timed(sample));
    }
    for (const hal::AxisSample& poll : polls) {
      assembler.add(timed(poll));
    }
  }

  std::optional<core::Outcome<Scanline, LineRejection>> make(double latency_s = 0.0) {
    assembler.begin_line({7, kTilt_rad, kStep_rad, kStep_rad});
    add_all();
    assembler.end_line(path_of(move), milliseconds(2100));
    EXPECT_FALSE(assembler.step(milliseconds(2199), {latency_s}).has_value());
    return assembler.step(milliseconds(2200), {latency_s});
  }
};

TEST_F(ScanAssemblerTest, AReadingHasThePanOfItsTime) {
  const auto line = make();
  ASSERT_TRUE(line.has_value() && line->has_value());
  const Scanline& made = **line;
  EXPECT_NEAR(static_cast<double>(made.readings.size()), 1000.0, 2.0);
  ASSERT_EQ(made.readings.size(), made.stamps.size());
  for (std::size_t i = 0; i < made.readings.size(); ++i) {
    const double true_rad = move.position_rad(hal::to_seconds(made.stamps[i] - kBegun));
    EXPECT_NEAR(made.readings[i].pan_rad, true_rad, 0.25 * kStep_rad);
    EXPECT_EQ(made.readings[i].range_m, 20.0);
  }
  EXPECT_EQ(made.line, 7U);
  EXPECT_EQ(made.direction, SweepDirection::Leftwards);
  EXPECT_NEAR(made.tilt_rad, kTilt_rad + kStep_rad, 1e-12);  // as it was polled meanwhile
  EXPECT_EQ(made.readings.front().tilt_rad, made.tilt_rad);
  EXPECT_LT(made.pan_sigma_rad, 0.3 * kStep_rad);
  EXPECT_TRUE(assembler.is_idle());
  EXPECT_EQ(assembler.count(AssemblerEvent::LinesFinished), 1U);
}

TEST_F(ScanAssemblerTest, TheLatencyIsAddedToTheStamp) {
  const auto line = make(0.02);
  ASSERT_TRUE(line.has_value() && line->has_value());
  const Scanline& made = **line;
  const hal::Stamp stamp = made.stamps[500];
  EXPECT_NEAR(made.readings[500].pan_rad, move.position_rad(hal::to_seconds(stamp - kBegun) + 0.02),
              0.25 * kStep_rad);
  EXPECT_NEAR(static_cast<double>(made.readings.size()), 1000.0, 2.0);
  EXPECT_EQ(made.latency_s, 0.02);
}

TEST_F(ScanAssemblerTest, OnlyAnEchoOfNoneIsNoReturn) {
  for (int i = 0; i < 100; ++i) {
    const auto n = static_cast<std::size_t>(i);
    samples[600 + n] = {samples[600 + n].stamp, 0.0, 0.0, hal::Echo::None};
    samples[700 + n] = {samples[700 + n].stamp, 3.0, 0.0, hal::Echo::Weak};
    samples[800 + n] = {samples[800 + n].stamp, 3.0, 0.0, hal::Echo::Saturated};
    samples[900 + n] = {samples[900 + n].stamp, 3.0, 0.0, hal::Echo::Fault};
    samples[1000 + n] = {samples[1000 + n].stamp, n % 2 == 0 ? std::nan("") : -1.0, 0.0, hal::Echo::Return};
  }
  const auto line = make();
  ASSERT_TRUE(line.has_value() && line->has_value());
  int none = 0;
  for (const core::Reading& reading : (*line)->readings) {
    none += reading.range_m == core::Reading::kNoReturn ? 1 : 0;
    EXPECT_TRUE(reading.range_m == 20.0 || reading.range_m == core::Reading::kNoReturn);
  }
  EXPECT_EQ(none, 100);
  EXPECT_NEAR(static_cast<double>((*line)->readings.size()), 600.0, 2.0);
  EXPECT_EQ(assembler.count(AssemblerEvent::ReadingsWeak), 100U);
  EXPECT_EQ(assembler.count(AssemblerEvent::ReadingsSaturated), 100U);
  EXPECT_EQ(assembler.count(AssemblerEvent::ReadingsFault), 200U);
}

TEST_F(ScanAssemblerTest, WhatHasNoRoomIsCounted) {
  while (samples.size() < 3010) {
    samples.push_back({milliseconds(2600), 20.0, 0.0, hal::Echo::Return});
  }
  while (polls.size() < 205) {
    polls.push_back({milliseconds(2600), {}, 500 * kStep_rad, hal::Axis::Pan});
  }
  const auto line = make();
  EXPECT_TRUE(line.has_value() && line->has_value());
  EXPECT_EQ(assembler.count(AssemblerEvent::ReadingsOverflow), 10U);
  EXPECT_EQ(assembler.count(AssemblerEvent::PollsOverflow), 5U);
}

TEST_F(ScanAssemblerTest, ATiltThatMovesRejectsTheLine) {
  polls.push_back({milliseconds(1800), milliseconds(2), kTilt_rad + 4 * kStep_rad, hal::Axis::Tilt});
  const auto line = make();
  ASSERT_TRUE(line.has_value() && !line->has_value());
  EXPECT_EQ(line->error(), LineRejection::LinesTiltMoved);
  EXPECT_EQ(assembler.count(AssemblerEvent::LinesTiltMoved), 1U);
}

TEST_F(ScanAssemblerTest, WithoutATiltPollItIsWhereItWasSeenToRest) {
  polls.pop_back();
  polls.push_back({milliseconds(2150), milliseconds(2), kTilt_rad + 9 * kStep_rad, hal::Axis::Tilt});
  const auto line = make();  // the poll is of the step after the line
  ASSERT_TRUE(line.has_value() && line->has_value());
  EXPECT_EQ((*line)->tilt_rad, kTilt_rad);
}

TEST_F(ScanAssemblerTest, RejectionsSayWhy) {
  auto line = make();
  polls.resize(6);
  line = make();
  ASSERT_TRUE(line.has_value() && !line->has_value());
  EXPECT_EQ(line->error(), LineRejection::LinesTooFewPolls);
  SetUp();
  samples.clear();
  line = make();
  ASSERT_TRUE(line.has_value() && !line->has_value());
  EXPECT_EQ(line->error(), LineRejection::LinesNoReadings);
}

TEST_F(ScanAssemblerTest, SamplesOutsideALineAreNotKept) {
  add_all();
  assembler.begin_line({0, kTilt_rad, kStep_rad, kStep_rad});
  assembler.abandon();
  add_all();
  assembler.end_line(path_of(move), milliseconds(2100));
  EXPECT_FALSE(assembler.step(milliseconds(9000), {}).has_value());
  EXPECT_EQ(assembler.count(AssemblerEvent::ReadingsOverflow), 0U);
}

}  // namespace
}  // namespace slamsensor::firmware
