// A carrier that leans in the simulated bush, differently at each stand: levelled, its scans fix as those of
// an upright one do (the paper's section II-A). SLAMSENSOR_SIM_SEEDS says how many worlds (default 4).

#include "core/detection/levelling.hpp"
#include "firmware/config/load_config.hpp"
#include "firmware/pipeline.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/output/result_files.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/simulate.hpp"
#include "tools/world/world_config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace slamsensor::tools {
namespace {

constexpr std::uint32_t kStands = 12;

std::uint64_t seed_count() {
  const char* const count = std::getenv("SLAMSENSOR_SIM_SEEDS");
  return count != nullptr ? std::strtoull(count, nullptr, 10) : 4;
}

enum class Levelled { No, Yes };

struct Outcome {
  std::size_t fixes = 0;
  std::size_t wrong = 0;
  double squares_m2 = 0.0;

  double rms_m() const {
    return std::sqrt(squares_m2 / static_cast<double>(std::max<std::size_t>(1, fixes)));
  }
};

/// Leans by `lean_rad` towards another side at each stand, so that roll and pitch mix in every way.
core::Attitude attitude_at(std::size_t stand, double lean_rad) {
  const double side_rad = 2.4 * static_cast<double>(stand);  // the golden angle: no side comes twice
  return core::attitude_of_up(
      {std::sin(lean_rad) * std::cos(side_rad), std::sin(lean_rad) * std::sin(side_rad), std::cos(lean_rad)});
}

void level(std::vector<std::vector<core::Reading>>& scanlines, const core::Attitude& attitude) {
  const core::Levelling levelling(attitude);
  for (auto& scanline : scanlines) {
    for (core::Reading& reading : scanline) {
      reading = levelling(reading);
    }
  }
}

Outcome drive(const World& world, const core::Config& config, double lean_rad, Levelled levelled,
              std::uint64_t seed) {
  DriveConfig way;
  way.stands = kStands;
  const auto stands = make_drive(world, way, seed);
  EXPECT_TRUE(stands) << stands.error().message;
  firmware::Pipeline pipeline(config);
  std::vector<TimedPose> truth;
  std::vector<FixRow> rows;
  for (std::size_t i = 0; i < stands->size(); ++i) {
    const core::Attitude attitude = attitude_at(i, lean_rad);
    SweepConfig sweep = paper_sweep_3_4();
    sweep.pan_step_rad *= 4.0;
    sweep.roll_rad = attitude.roll_rad;
    sweep.pitch_rad = attitude.pitch_rad;
    auto scanlines = scan(world, sweep, (*stands)[i].pose, (*stands)[i].time_s, 1000 * seed + i);
    if (levelled == Levelled::Yes) {
      level(scanlines, attitude);
    }
    const core::Fix fix = pipeline.process(scanlines, {}, {});
    truth.push_back({static_cast<double>(i), (*stands)[i].pose});
    rows.push_back({static_cast<std::int64_t>(i), static_cast<double>(i), fix, {}});
  }
  const auto evaluation = evaluate(truth, trajectory_of(rows));
  EXPECT_TRUE(evaluation);
  Outcome outcome;
  outcome.fixes = evaluation->fixes;
  if (evaluation->first_fix) {
    outcome.wrong = evaluation->first_fix->wrong_fixes;
    outcome.squares_m2 = evaluation->first_fix->ate_rms_m * evaluation->first_fix->ate_rms_m *
                         static_cast<double>(outcome.fixes);
  }
  return outcome;
}

struct Case {
  const char* name;
  double lean_deg;
  Levelled levelled;
  Outcome all;
};

// At 5 degrees a scan that is not levelled has distances 0.4 % off and bearings 0.1 degree: it still fixes
// often, at a larger error. At 10 degrees it does not, and gives wrong fixes.
TEST(LeaningCarrier, FixesLikeAnUprightOneWhenLevelled) {
  const auto folder = tests::source_tree() / "config";
  const auto config = firmware::load_config(folder / "experiment-3.toml");
  ASSERT_TRUE(config) << firmware::error_lines(config.error());
  auto world_config = load_world(folder / "worlds" / "bush.toml");
  ASSERT_TRUE(world_config) << world_config.error().message;
  Case upright{"upright", 0.0, Levelled::No, {}};
  Case levelled{"5 deg, levelled", 5.0, Levelled::Yes, {}};
  Case leaning{"5 deg, not levelled", 5.0, Levelled::No, {}};
  Case far_levelled{"10 deg, levelled", 10.0, Levelled::Yes, {}};
  Case far_leaning{"10 deg, not levelled", 10.0, Levelled::No, {}};
  for (std::uint64_t seed = 1; seed <= seed_count(); ++seed) {
    world_config->seed = 7000 + seed;
    const auto world = World::create(*world_config);
    ASSERT_TRUE(world) << world.error().message;
    for (Case* const c : {&upright, &levelled, &leaning, &far_levelled, &far_leaning}) {
      const Outcome one = drive(*world, config->config.core, c->lean_deg * core::kDegree, c->levelled, seed);
      std::printf("seed %llu %-21s %2zu of %u fixes, %zu wrong, rms %.3f m\n",
                  static_cast<unsigned long long>(seed), c->name, one.fixes, kStands, one.wrong, one.rms_m());
      c->all.fixes += one.fixes;
      c->all.wrong += one.wrong;
      c->all.squares_m2 += one.squares_m2;
    }
  }
  EXPECT_EQ(levelled.all.wrong, 0U);
  EXPECT_EQ(far_levelled.all.wrong, 0U);
  const auto share_of_upright = [&](const Case& c) {
    return static_cast<double>(c.all.fixes) / static_cast<double>(upright.all.fixes);
  };
  // With 20 landmarks a scan one stand in some worlds is not found, and the rest of the drive is in a local
  // map then.
  EXPECT_GE(share_of_upright(levelled), 0.75);
  EXPECT_GE(share_of_upright(far_levelled), 0.85);
  EXPECT_LE(levelled.all.rms_m(), 1.5 * upright.all.rms_m());
  EXPECT_LE(leaning.all.fixes, levelled.all.fixes);
  EXPECT_LT(far_leaning.all.fixes, far_levelled.all.fixes);
  EXPECT_LE(share_of_upright(far_leaning), 0.6);
}

}  // namespace
}  // namespace slamsensor::tools
