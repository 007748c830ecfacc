// The paper's experiments through the devices' own bytes: emulated PTU-46-17.5 and rangefinder, their
// protocols and timing, the drivers, the angle of each reading, detection and SLAM; beside them the same
// stands with readings taken straight from the world. SLAMSENSOR_BYTE_SCANS says how many scans a drive has
// (default 6).

#include "firmware/config/load_config.hpp"
#include "firmware/pipeline.hpp"
#include "tests/support/results.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/drive/byte_drive.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/world/simulate.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

const std::filesystem::path kConfigDir = tests::source_tree() / "config";
constexpr double kMilliDegrees = 1000.0 / core::kDegree;

std::uint32_t scan_count() {
  const char* const count = std::getenv("SLAMSENSOR_BYTE_SCANS");
  return count != nullptr ? static_cast<std::uint32_t>(std::strtoul(count, nullptr, 10)) : 6;
}

Scenario paper_scenario(std::uint64_t seed) {
  auto scenario = load_scenario(kConfigDir / "scenarios" / "paper.toml");
  EXPECT_TRUE(scenario) << scenario.error().message;
  scenario->seed = seed;
  scenario->world.seed = seed;
  scenario->drive.stands = scan_count();
  return *scenario;
}

firmware::SensorHeadConfig head_config(int experiment) {
  firmware::SensorHeadConfig config;
  if (experiment > 2) {  // 26 scanlines from -17.5 deg by 1.03 deg
    config.scan.tilt_min_rad = -340.0 * firmware::kPaperStep_rad;
    config.scan.tilt_max_rad = 160.0 * firmware::kPaperStep_rad;
    config.scan.tilt_step_rad = 20.0 * firmware::kPaperStep_rad;
  }
  return config;
}

/// Fixes of a drive and how they compare with the truth.
class Fixes {
 public:
  explicit Fixes(const core::Config& config) : pipeline_(config) {}

  void add(const std::vector<std::vector<core::Reading>>& scanlines, const core::Pose2& stand_W) {
    const auto time = static_cast<double>(truth_.size());
    const core::Fix fix = pipeline_.process(scanlines, {}, {});
    truth_.push_back({time, stand_W});
    if (fix.status == core::FixStatus::Fix) {
      trajectory_.push_back({time, fix.pose_W});
    }
  }

  Evaluation result() const {
    const auto evaluation = evaluate(truth_, trajectory_);
    EXPECT_TRUE(evaluation);
    return *evaluation;
  }

 private:
  firmware::Pipeline pipeline_;
  std::vector<TimedPose> truth_;
  std::vector<TimedPose> trajectory_;
};

class ByteExperiments : public testing::TestWithParam<int> {};

TEST_P(ByteExperiments, FixAsReadingsFromTheWorldDo) {
  const int experiment = GetParam();
  const auto config =
      firmware::load_config(kConfigDir / ("experiment-" + std::to_string(experiment) + ".toml"));
  ASSERT_TRUE(config) << firmware::error_lines(config.error());
  const auto seed = static_cast<std::uint64_t>(4000 + experiment);
  const Scenario scenario = paper_scenario(seed);
  auto drive = ByteDrive::create(scenario, head_config(experiment));
  ASSERT_TRUE(drive) << drive.error().message;
  const SweepConfig sweep = experiment <= 2 ? paper_sweep_1_2() : paper_sweep_3_4();
  Fixes bytes(config->config.core);
  Fixes straight(config->config.core);
  PanErrors worst;
  for (std::uint32_t i = 0; i < scan_count(); ++i) {
    const auto driven = (*drive)->next_scan(600.0);
    ASSERT_TRUE(driven) << "seed " << seed << " scan " << i << ": " << (*drive)->sensor().problem();
    EXPECT_EQ(driven->ended.lines_rejected, 0U);
    EXPECT_EQ(driven->scanlines.size(), line_count(sweep));
    worst.rms_rad = std::max(worst.rms_rad, driven->pan.rms_rad);
    worst.worst_rad = std::max(worst.worst_rad, driven->pan.worst_rad);
    bytes.add(driven->scanlines, driven->stand_W);
    straight.add(scan((*drive)->head().head().world(), sweep, driven->stand_W, 300.0 * i, seed + i),
                 driven->stand_W);
  }
  const Evaluation ours = bytes.result();
  const Evaluation theirs = straight.result();
  ASSERT_TRUE(ours.first_fix && theirs.first_fix);
  std::printf(
      "experiment %d: bytes %zu of %u fixes, %zu wrong, RMS %.3f m; straight %zu, %zu wrong, RMS %.3f m; "
      "pan RMS %.1f worst %.1f mdeg\n",
      experiment, ours.fixes, scan_count(), ours.first_fix->wrong_fixes, ours.first_fix->ate_rms_m,
      theirs.fixes, theirs.first_fix->wrong_fixes, theirs.first_fix->ate_rms_m, worst.rms_rad * kMilliDegrees,
      worst.worst_rad * kMilliDegrees);
  tests::keep_results("bytes-experiment-" + std::to_string(experiment),
                      {{"scans", static_cast<double>(scan_count())},
                       {"fixes", static_cast<double>(ours.fixes)},
                       {"wrong", static_cast<double>(ours.first_fix->wrong_fixes)},
                       {"pan_rms_mdeg", worst.rms_rad * kMilliDegrees}});
  EXPECT_EQ(ours.first_fix->wrong_fixes, 0U) << "seed " << seed;
  EXPECT_GE(ours.fixes + 1, theirs.fixes) << "seed " << seed;
  EXPECT_LT(worst.rms_rad * kMilliDegrees, 15.0) << "seed " << seed;
}

TEST(CanHead, ScansAsTheSerialOneDoes) {
  Scenario scenario = paper_scenario(6001);
  scenario.drive.stands = 1;
  scenario.head.ptu.unit = PanTiltModel::CanOpen;
  scenario.head.rangefinder.unit = RangefinderModel::Tf03Can;
  auto drive = ByteDrive::create(scenario, head_config(3));
  ASSERT_TRUE(drive) << drive.error().message;
  const auto driven = (*drive)->next_scan(600.0);
  ASSERT_TRUE(driven) << (*drive)->sensor().problem();
  EXPECT_EQ(driven->scanlines.size(), 26U);
  EXPECT_EQ(driven->ended.lines_rejected, 0U);
  // Ramps are swept too.
  EXPECT_LT(driven->pan.rms_rad * kMilliDegrees, 5.0);
  EXPECT_LT(driven->pan.worst_rad * kMilliDegrees, 15.0);
}

INSTANTIATE_TEST_SUITE_P(Paper, ByteExperiments, testing::Values(1, 2, 3, 4));

struct LatencyCase {
  double rangefinder_s;
  double position_s;
  double jitter_s;
};

class Latency : public testing::TestWithParam<LatencyCase> {};

TEST_P(Latency, IsFoundByTheSensorItself) {
  const auto [rangefinder_s, position_s, jitter_s] = GetParam();
  Scenario scenario = paper_scenario(5001);
  scenario.drive.stands = 1;
  scenario.head.rangefinder.latency_s = rangefinder_s;
  scenario.head.rangefinder.jitter_s = jitter_s;
  scenario.head.ptu.position_age_s = position_s;
  std::vector<PanErrors> errors;
  for (const bool calibrates : {false, true}) {
    firmware::SensorHeadConfig config = head_config(3);
    config.latency.self_calibration = calibrates;
    auto drive = ByteDrive::create(scenario, config);
    ASSERT_TRUE(drive) << drive.error().message;
    const auto driven = (*drive)->next_scan(600.0);
    ASSERT_TRUE(driven) << (*drive)->sensor().problem();
    errors.push_back(driven->pan);
  }
  std::printf(
      "rangefinder %4.1f ms, positions %4.1f ms, jitter %3.1f ms: pan RMS %7.1f worst %7.1f mdeg before, "
      "%5.1f worst %5.1f mdeg after\n",
      rangefinder_s * 1e3, position_s * 1e3, jitter_s * 1e3, errors[0].rms_rad * kMilliDegrees,
      errors[0].worst_rad * kMilliDegrees, errors[1].rms_rad * kMilliDegrees,
      errors[1].worst_rad * kMilliDegrees);
  tests::keep_results("latency-" + std::to_string(static_cast<int>(rangefinder_s * 1e3)) + "-" +
                          std::to_string(static_cast<int>(position_s * 1e3)) + "-" +
                          std::to_string(static_cast<int>(jitter_s * 1e3)),
                      {{"before_rms_mdeg", errors[0].rms_rad * kMilliDegrees},
                       {"after_rms_mdeg", errors[1].rms_rad * kMilliDegrees}});
  // A reading's own jitter of 1 ms is 51 mdeg of pan that no calibration can know.
  EXPECT_LT(errors[1].rms_rad * kMilliDegrees, jitter_s > 0.0 ? 30.0 : 15.0);
}

INSTANTIATE_TEST_SUITE_P(Devices, Latency,
                         testing::Values(LatencyCase{0.0, 0.0, 0.0}, LatencyCase{0.005, 0.0, 0.0},
                                         LatencyCase{0.02, 0.0, 0.0}, LatencyCase{0.0, 0.005, 0.0},
                                         LatencyCase{0.0, 0.02, 0.0}, LatencyCase{0.02, 0.005, 0.001},
                                         LatencyCase{0.0, 0.02, 0.001}));

}  // namespace
}  // namespace slamsensor::tools
