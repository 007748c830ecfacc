// The paper's experiments in simulated worlds: seeded drives, whole pipeline from readings to fixes, judged
// against the truth. SLAMSENSOR_SIM_SEEDS says how many seeds (default 4; 20 for the table of the README).

#include "firmware/config/load_config.hpp"
#include "firmware/pipeline.hpp"
#include "tests/support/results.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/simulate.hpp"
#include "tools/world/world_config.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

const std::filesystem::path kConfigDir = tests::source_tree() / "config";

std::uint64_t seed_count() {
  const char* const count = std::getenv("SLAMSENSOR_SIM_SEEDS");
  return count != nullptr ? std::strtoull(count, nullptr, 10) : 4;
}

struct Outcome {
  std::size_t scans = 0;
  std::size_t fixes = 0;
  std::size_t ambiguous = 0;
  std::size_t wrong = 0;
  double rms_m = 0.0;
  double max_m = 0.0;
  std::vector<double>
      nees;  // normalised estimation error squared of the fixes that are no origin, 3 degrees of freedom
  std::uint32_t map = 0;
  std::vector<double> milliseconds;  // one core, detection and association
};

double nees_of(const core::Fix& fix, const core::Pose2& truth) {
  const Eigen::Vector3d error(fix.pose_W.x_m - truth.x_m, fix.pose_W.y_m - truth.y_m,
                              core::wrap_angle(fix.pose_W.heading_rad - truth.heading_rad));
  return error.dot(fix.covariance.inverse() * error);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

/// Where the frames of the maps lie: each in the truth of the scan that began it.
class Origins {
 public:
  void note(const core::Atlas& atlas, const core::Pose2& truth) {
    for (const core::MapEntry& map : atlas.maps()) {
      if (map.number != 0) {
        origins_.try_emplace(map.number, truth);
      }
    }
  }
  [[nodiscard]] const core::Pose2& of(std::uint32_t map) const { return origins_.at(map); }

 private:
  std::map<std::uint32_t, core::Pose2> origins_;
};

/// A poor home map may give way to another, whose frame is that of another scan.
void judge(const core::Fix& fix, const core::Pose2& origin, const core::Pose2& truth, Outcome& outcome) {
  const EvaluationConfig limits;
  const core::Pose2 error = truth.inverse() * (origin * fix.pose_W);
  const double error_m = error.translation().norm();
  outcome.wrong +=
      error_m > limits.wrong_distance_m || std::abs(error.heading_rad) > limits.wrong_heading_rad ? 1 : 0;
  outcome.rms_m =
      std::sqrt((outcome.rms_m * outcome.rms_m * static_cast<double>(outcome.fixes) + error_m * error_m) /
                static_cast<double>(outcome.fixes + 1));
  outcome.max_m = std::max(outcome.max_m, error_m);
  ++outcome.fixes;
  if (fix.matches > 0) {  // else it is the scan that began the map: the origin is no estimate
    outcome.nees.push_back(nees_of(fix, origin.inverse() * truth));
  }
}

Outcome drive(const World& world, const core::Config& config, const SweepConfig& sweep,
              const DriveConfig& way, std::uint64_t seed) {
  Outcome outcome;
  const auto stands = make_drive(world, way, seed);
  EXPECT_TRUE(stands) << stands.error().message;
  firmware::Pipeline pipeline(config);
  Origins origins;
  for (std::size_t i = 0; i < stands->size(); ++i) {
    const Stand& stand = (*stands)[i];
    const auto scanlines = scan(world, sweep, stand.pose, stand.time_s, 1000 * seed + i);
    const auto begin = std::chrono::steady_clock::now();
    const core::Fix fix = pipeline.process(scanlines, {}, {});
    outcome.milliseconds.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    origins.note(*pipeline.slam().atlas(), stand.pose);
    ++outcome.scans;
    outcome.ambiguous += fix.status == core::FixStatus::Ambiguous ? 1 : 0;
    outcome.map = fix.landmarks_in_map;
    if (fix.status == core::FixStatus::Fix) {
      judge(fix, origins.of(fix.map), stand.pose, outcome);
    }
  }
  return outcome;
}

struct Case {
  const char* world;
  int experiment;
  double fixes_share_min;  ///< of all scans of all seeds
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.world << ", experiment " << c.experiment;
}

class Experiments : public testing::TestWithParam<Case> {};

TEST_P(Experiments, FixWithoutAWrongOne) {
  const auto [world_name, experiment, fixes_share_min] = GetParam();
  const auto config =
      firmware::load_config(kConfigDir / ("experiment-" + std::to_string(experiment) + ".toml"));
  ASSERT_TRUE(config) << firmware::error_lines(config.error());
  auto world_config = load_world(kConfigDir / "worlds" / world_name);
  ASSERT_TRUE(world_config) << world_config.error().message;
  const SweepConfig sweep = experiment <= 2 ? paper_sweep_1_2() : paper_sweep_3_4();
  DriveConfig way;
  way.stands = 20;
  way.step_m = 5.0;
  way.kidnap_share = 0.1;
  Outcome all;
  std::printf("%-16s seed  fixes ambiguous wrong  rms m  max m   map  median ms  NEES\n", world_name);
  for (std::uint64_t n = 1; n <= seed_count(); ++n) {
    const std::uint64_t seed =
        1000 * static_cast<std::uint64_t>(experiment) + n;  // each experiment its own worlds
    world_config->seed = seed;
    const auto world = World::create(*world_config);
    ASSERT_TRUE(world) << world.error().message;
    Outcome one = drive(*world, config->config.core, sweep, way, seed);
    std::printf("experiment %d %9llu %3zu/%zu %9zu %5zu %6.3f %6.3f %5u %10.2f %8.1f\n", experiment,
                static_cast<unsigned long long>(seed), one.fixes, one.scans, one.ambiguous, one.wrong,
                one.rms_m, one.max_m, one.map, median(one.milliseconds), median(one.nees));
    EXPECT_EQ(one.wrong, 0U) << "seed " << seed;
    all.scans += one.scans;
    all.fixes += one.fixes;
    all.wrong += one.wrong;
    all.nees.insert(all.nees.end(), one.nees.begin(), one.nees.end());
  }
  tests::keep_results(
      std::filesystem::path(world_name).stem().string() + "-experiment-" + std::to_string(experiment),
      {{"scans", static_cast<double>(all.scans)},
       {"fixes", static_cast<double>(all.fixes)},
       {"wrong", static_cast<double>(all.wrong)},
       {"seeds", static_cast<double>(seed_count())}});
  EXPECT_GE(static_cast<double>(all.fixes), fixes_share_min * static_cast<double>(all.scans));
  // Honest covariances: the median of chi-squared with 3 degrees of freedom is 2.4, its 90 % quantile 6.3.
  EXPECT_LE(median(all.nees), 6.3);
}

// A plantation of rows looks the same from many places: there, only silence is asked for, no fixes.
INSTANTIATE_TEST_SUITE_P(Worlds, Experiments,
                         testing::Values(Case{"bush.toml", 1, 0.85}, Case{"bush.toml", 2, 0.9},
                                         Case{"bush.toml", 3, 0.9}, Case{"bush.toml", 4, 0.7},
                                         Case{"park.toml", 1, 0.5}, Case{"park.toml", 3, 0.5},
                                         Case{"plantation.toml", 1, 0.0}, Case{"plantation.toml", 3, 0.0}));

}  // namespace
}  // namespace slamsensor::tools
