#include "core/sweep/latency_calibration.hpp"

#include "tests/unit/firmware/scan/head_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace slamsensor::firmware {
namespace {

using core::LatencyCalibration;
using core::LatencyEvent;

constexpr double kSpeed_radps = 1000 * kPaperStep_rad;
constexpr double kPanMax_rad = 2000 * kPaperStep_rad;

using RangeAt = std::function<double(double pan_rad, std::uint32_t line)>;

double posts_m(double pan_rad, std::uint32_t) {
  const hal::RangeSample sample = posts(pan_rad, 0.0, {});
  return sample.range_m;
}

/// A line of a head whose readings are really `latency_s` later on their way than they are taken for.
struct FakeLine {
  std::vector<core::Reading> readings;
  std::vector<hal::Stamp> stamps;
  Scanline line;

  FakeLine(std::uint32_t number, double latency_s, double assumed_s, const RangeAt& world) {
    const bool leftwards = number % 2 == 0;
    const double sense = leftwards ? 1.0 : -1.0;
    for (double pan_rad = -kPanMax_rad; pan_rad < kPanMax_rad; pan_rad += kPaperStep_rad) {
      const double told_rad = sense * (pan_rad + 0.37 * kPaperStep_rad);
      const double true_rad = told_rad + sense * kSpeed_radps * (latency_s - assumed_s);
      readings.push_back({told_rad, 0.0, world(true_rad, number)});
      stamps.emplace_back(0);
    }
    line.readings = readings;
    line.stamps = stamps;
    line.direction = leftwards ? SweepDirection::Leftwards : SweepDirection::Rightwards;
    line.line = number;
    line.pan_radps = kSpeed_radps;
    line.steady_min_rad = -kPanMax_rad;
    line.steady_max_rad = kPanMax_rad;
    line.fit_sigma_s = 2e-5;
    line.latency_s = assumed_s;
  }
};

void pass(LatencyCalibration& calibration, double latency_s, std::uint32_t lines = 4,
          const RangeAt& world = posts_m) {
  calibration.begin_pass(-kPanMax_rad, kPanMax_rad, kPaperStep_rad);
  for (std::uint32_t number = 0; number < lines; ++number) {
    const FakeLine made(number, latency_s, calibration.latency().latency_s, world);
    calibration.add(made.line);
    for (int steps = 0; calibration.is_busy(); ++steps) {
      ASSERT_LT(steps, 1000);
      calibration.step();
    }
  }
  calibration.end_pass();
}

TEST(LatencyCalibration, FindsLatenciesOfEitherSign) {
  // All lines have their readings at the same places, so that the error of an edge does not average out.
  for (const double latency_s : {-0.05, -0.0203, 0.0, 0.0001, 0.00525, 0.0201, 0.055}) {
    LatencyCalibration calibration({});
    pass(calibration, latency_s);
    EXPECT_NEAR(calibration.latency().latency_s, latency_s, 1e-4) << latency_s;
    EXPECT_LT(calibration.latency().sigma_s, 2e-4);
    EXPECT_EQ(calibration.latency().pairs, 3U);
    pass(calibration, latency_s);
    EXPECT_NEAR(calibration.latency().latency_s, latency_s, 1e-4) << "on top of what is known";
    EXPECT_EQ(calibration.count(LatencyEvent::PassesTaken), 2U);
  }
}

TEST(LatencyCalibration, NoiseAndPeopleDoNotMoveIt) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 rng(seed);
    const auto busy = [&](double pan_rad, std::uint32_t line) {
      const double person_rad = -1.0 + 0.05 * line;  // walks to the left
      const double range_m = std::abs(pan_rad - person_rad) < 0.04 ? 5.0 : posts_m(pan_rad, line);
      return range_m > 0.0 ? range_m + 0.35 * (tests::draw(rng) - 0.5) : range_m;
    };
    LatencyCalibration calibration({});
    pass(calibration, 0.012, 6, busy);
    EXPECT_NEAR(calibration.latency().latency_s, 0.012, 1e-4) << "seed " << seed;
  }
}

TEST(LatencyCalibration, WhatTheTiltDisplacesCancels) {
  const auto leaning = [](double pan_rad, std::uint32_t line) {
    return posts_m(pan_rad - 2e-4 * line, line);  // all stems lean to the left: 0.22 ms a line
  };
  LatencyCalibration calibration({});
  pass(calibration, 0.004, 11, leaning);
  EXPECT_NEAR(calibration.latency().latency_s, 0.004, 5e-5);
  EXPECT_GT(std::abs(calibration.pairs()[0].latency_s - calibration.pairs()[1].latency_s), 1e-4);
}

TEST(LatencyCalibration, AWorldWithoutEdgesIsRefused) {
  LatencyConfig config;
  config.initial_s = 0.004;
  LatencyCalibration calibration(config);
  std::mt19937_64 rng(3);
  pass(calibration, 0.02, 4, [&](double, std::uint32_t) { return 40.0 + 0.3 * (tests::draw(rng) - 0.5); });
  EXPECT_EQ(calibration.count(LatencyEvent::PairsNoEdges), 3U);
  EXPECT_EQ(calibration.count(LatencyEvent::PassesRefused), 1U);
  EXPECT_EQ(calibration.latency().latency_s, 0.004);
  EXPECT_EQ(calibration.latency().pairs, 0U);
}

TEST(LatencyCalibration, AFenceOfEvenPostsIsRefused) {
  LatencyCalibration calibration({});
  pass(calibration, 0.0, 4, [](double pan_rad, std::uint32_t) {
    return std::fmod(pan_rad + 10.0, 0.05) < 0.01 ? 10.0 : 60.0;  // the same again after 28 ms
  });
  EXPECT_EQ(calibration.count(LatencyEvent::PairsAmbiguous), 3U);
  EXPECT_EQ(calibration.latency().pairs, 0U);
}

TEST(LatencyCalibration, ALatencyBeyondTheSearchIsNotMadeUp) {
  LatencyConfig config;
  config.search_s = 0.01;
  LatencyCalibration calibration(config);
  pass(calibration, 0.02);
  EXPECT_EQ(calibration.count(LatencyEvent::PairsUsed), 0U);
}

TEST(LatencyCalibration, DeparturesAreCountedAndBelievedAfterConfirmation) {
  LatencyCalibration calibration({});
  pass(calibration, 0.003);
  pass(calibration, 0.010);  // once: an accident
  EXPECT_NEAR(calibration.latency().latency_s, 0.003, 1e-4);
  EXPECT_EQ(calibration.count(LatencyEvent::LatencyDeparted), 1U);
  pass(calibration, 0.003);
  pass(calibration, 0.008);
  pass(calibration, 0.008);
  EXPECT_NEAR(calibration.latency().latency_s, 0.003, 1e-4);
  EXPECT_EQ(calibration.count(LatencyEvent::LatencyTakenOver), 0U);
  pass(calibration, 0.008);
  EXPECT_NEAR(calibration.latency().latency_s, 0.008, 1e-4);
  EXPECT_EQ(calibration.count(LatencyEvent::LatencyDeparted), 4U);
  EXPECT_EQ(calibration.count(LatencyEvent::LatencyTakenOver), 1U);
}

TEST(LatencyCalibration, WorkThatIsNotDoneInTimeIsDropped) {
  LatencyCalibration calibration({});
  calibration.begin_pass(-kPanMax_rad, kPanMax_rad, kPaperStep_rad);
  for (std::uint32_t number = 0; number < 3; ++number) {
    calibration.add(FakeLine(number, 0.0, 0.0, posts_m).line);
    calibration.step();
  }
  calibration.end_pass();
  EXPECT_EQ(calibration.count(LatencyEvent::PairsDropped), 2U);
  EXPECT_EQ(calibration.count(LatencyEvent::PassesRefused), 1U);
  EXPECT_FALSE(calibration.is_busy());
}

TEST(LatencyCalibration, LinesThatAreNotNeighboursAreNoPair) {
  LatencyCalibration calibration({});
  calibration.begin_pass(-kPanMax_rad, kPanMax_rad, kPaperStep_rad);
  calibration.add(FakeLine(0, 0.0, 0.0, posts_m).line);
  calibration.add(FakeLine(3, 0.0, 0.0, posts_m).line);
  EXPECT_FALSE(calibration.is_busy());
  calibration.add(FakeLine(5, 0.0, 0.0, posts_m).line);
  EXPECT_FALSE(calibration.is_busy());
}

TEST(LatencyCalibration, ANarrowSweepIsRefused) {
  LatencyCalibration calibration({});
  calibration.begin_pass(-0.05, 0.05, kPaperStep_rad);
  calibration.add(FakeLine(0, 0.0, 0.0, posts_m).line);
  calibration.add(FakeLine(1, 0.0, 0.0, posts_m).line);
  calibration.step();
  EXPECT_EQ(calibration.count(LatencyEvent::PairsNoOverlap), 1U);
}

TEST(LatencyCalibration, SwitchedOffItLeavesTheConfiguredValue) {
  LatencyConfig config;
  config.self_calibration = false;
  config.initial_s = -0.002;
  LatencyCalibration calibration(config);
  pass(calibration, 0.01);
  EXPECT_EQ(calibration.latency().latency_s, -0.002);
  EXPECT_EQ(calibration.latency().sigma_s, 0.0);
}

}  // namespace
}  // namespace slamsensor::firmware
