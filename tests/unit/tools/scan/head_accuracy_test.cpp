#include "firmware/scan/sensor_head.hpp"
#include "tests/support/fake_head.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/world/simulate.hpp"
#include "tools/world/world.hpp"
#include "tools/world/world_config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace slamsensor::tools {
namespace {

constexpr double kMilliDegree = std::numbers::pi / 180e3;

World bush(std::uint64_t seed) {
  const auto folder = tests::source_tree() / "config/worlds";
  auto config = load_world(folder / "bush.toml");
  EXPECT_TRUE(config.has_value()) << config.error().message;
  config->seed = seed;
  auto world = World::create(*config);
  EXPECT_TRUE(world.has_value()) << world.error().message;
  return std::move(*world);
}

/// How far the pan of readings is from the truth.
struct PanError {
  double sum2 = 0.0;
  double worst_rad = 0.0;
  std::size_t count = 0;

  void add(double off_rad) {
    sum2 += off_rad * off_rad;
    worst_rad = std::max(worst_rad, std::abs(off_rad));
    ++count;
  }
  [[nodiscard]] double rms_mdeg() const {
    return std::sqrt(sum2 / static_cast<double>(count)) / kMilliDegree;
  }
  [[nodiscard]] double worst_mdeg() const { return worst_rad / kMilliDegree; }
};

struct Outcome {
  PanError before;  // with the latency as configured: 0
  PanError after;   // with the latency that the head has found
  double latency_error_s = 0.0;
  core::Latency latency;
};

struct Setting {
  double pan_latency_s = 0.0;
  double range_latency_s = 0.0;
  std::uint64_t seed = 0;
};

firmware::SensorHeadConfig head_config() {
  firmware::SensorHeadConfig config;
  config.scan.mode = firmware::ScanMode::Single;
  config.scan.tilt_min_rad = -40.0 * firmware::kPaperStep_rad;
  config.scan.tilt_max_rad = 40.0 * firmware::kPaperStep_rad;
  return config;
}

/// The start-up calibration and one scan of nine lines in the bush, stepped every millisecond. What of the
/// true latency cannot be told from a shift of the whole map is the mean of the poll jitter, which is part
/// of it.
Outcome run(const Setting& setting) {
  constexpr double kJitter_s = 0.001;
  const World world = bush(setting.seed);
  Random rng(mix_seed(setting.seed, 1));
  core::Pose2 pose_W;
  do {
    pose_W = {draw_uniform(rng, -100.0, 100.0), draw_uniform(rng, -100.0, 100.0),
              draw_uniform(rng, -3.0, 3.0)};
  } while (!world.is_free({pose_W.x_m, pose_W.y_m}, 1.0));
  const SensorPlace place = sensor_place(world, SweepConfig{}, pose_W);
  tests::FakePanTilt unit({.latency_s = setting.pan_latency_s,
                           .jitter_s = kJitter_s,
                           .slowness = draw_uniform(rng, -2e-4, 2e-4),
                           .seed = mix_seed(setting.seed, 2)});
  tests::FakeRangefinder rangefinder(
      {.latency_s = setting.range_latency_s, .seed = mix_seed(setting.seed, 3)}, unit,
      [&](double pan_rad, double tilt_rad, hal::Stamp at) {
        const Eigen::Vector3d direction_L(std::cos(tilt_rad) * std::cos(pan_rad),
                                          std::cos(tilt_rad) * std::sin(pan_rad), std::sin(tilt_rad));
        const Range range = world.cast(place.position_W, place.R_W_L * direction_L, hal::to_seconds(at), rng);
        return range.has_return() ? hal::RangeSample{{}, range.range_m, 0.0, hal::Echo::Return}
                                  : hal::RangeSample{};
      });
  firmware::SensorHead head(unit, rangefinder, head_config());
  head.request_scan();
  Outcome outcome;
  const double true_latency_s = setting.pan_latency_s - 0.5 * kJitter_s - setting.range_latency_s;
  bool has_ended = false;
  for (int ms = 1; ms < 200'000 && !has_ended; ++ms) {
    head.step(std::chrono::milliseconds(ms));
    while (const auto event = head.take()) {
      has_ended = has_ended || std::holds_alternative<firmware::ScanEnded>(*event);
      const auto* const line = std::get_if<firmware::Scanline>(&*event);
      for (std::size_t i = 0; line != nullptr && i < line->readings.size(); ++i) {
        const double off_rad = line->readings[i].pan_rad - rangefinder.true_pan_rad(line->stamps[i]);
        const double moved_rad = line->latency_s * head.assembler().pan_fit().speed_radps(line->stamps[i]);
        outcome.after.add(off_rad);
        outcome.before.add(off_rad - moved_rad);
      }
      outcome.latency_error_s = line != nullptr ? line->latency_s - true_latency_s : outcome.latency_error_s;
    }
    outcome.latency = has_ended ? outcome.latency : head.latency();
  }
  EXPECT_TRUE(has_ended);
  return outcome;
}

class HeadAccuracy : public ::testing::TestWithParam<Setting> {};

TEST_P(HeadAccuracy, PanIsTrueToTenMilliDegreesAfterTheStartUpCalibration) {
  const Setting& setting = GetParam();
  SCOPED_TRACE(testing::Message() << "seed " << setting.seed);
  const Outcome outcome = run(setting);
  std::cout << "latency of polls " << setting.pan_latency_s * 1e3 << " ms, of readings "
            << setting.range_latency_s * 1e3 << " ms, seed " << setting.seed << ": pan error before "
            << outcome.before.rms_mdeg() << " rms " << outcome.before.worst_mdeg() << " worst, after "
            << outcome.after.rms_mdeg() << " rms " << outcome.after.worst_mdeg()
            << " worst (mdeg); latency off by " << outcome.latency_error_s * 1e3 << " ms, told sigma "
            << outcome.latency.sigma_s * 1e3 << " ms, " << outcome.latency.pairs << " pairs\n";
  EXPECT_LT(outcome.after.rms_mdeg(), 10.0);
  EXPECT_LT(std::abs(outcome.latency_error_s), 5.0 * outcome.latency.sigma_s + 5e-5);
  EXPECT_GE(outcome.latency.pairs, 2U);
}

INSTANTIATE_TEST_SUITE_P(Latencies, HeadAccuracy,
                         testing::Values(Setting{0.0, 0.0, 101}, Setting{0.005, 0.0, 102},
                                         Setting{0.0, 0.005, 103}, Setting{0.02, 0.0, 104},
                                         Setting{0.0, 0.02, 105}, Setting{0.02, 0.005, 106}));

}  // namespace
}  // namespace slamsensor::tools
