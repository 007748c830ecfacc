// The product on the real data sets, end to end. The sets are not part of the project: SLAMSENSOR_DATA names
// their folder, and without it these tests skip.

#include "core/localizer.hpp"
#include "firmware/config/load_config.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"
#include "tests/support/results.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/input/text_files.hpp"
#include "tools/output/result_files.hpp"
#include "tools/replay/replay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

std::filesystem::path data_folder() {
  const char* const folder = std::getenv("SLAMSENSOR_DATA");
  return folder != nullptr ? folder : tests::source_tree() / "../shared/data";
}

firmware::Config profile(const std::string& name) {
  auto loaded = firmware::load_config(tests::source_tree() / "config" / name);
  EXPECT_TRUE(loaded) << firmware::error_lines(loaded.error());
  return loaded ? loaded->config : firmware::Config{};
}

class RealData : public testing::Test {
 protected:
  /// Replays one set with its profile; prints its evaluation.
  Evaluation run(const std::string& set, const std::string& input) {
    const std::filesystem::path folder = data_folder() / set;
    const auto result = replay({input.empty() ? folder : folder / input}, profile(set + ".toml"));
    EXPECT_TRUE(result) << result.error().message;
    const auto truth = read_tum(folder / "reference.tum");
    EXPECT_TRUE(truth) << truth.error().message;
    if (!result || !truth) {
      return {};
    }
    EXPECT_TRUE(result->refused.empty());
    const auto evaluation = evaluate(*truth, trajectory_of(result->rows));
    EXPECT_TRUE(evaluation);
    std::printf("%s\n%s\n", set.c_str(), evaluation_text(*evaluation).c_str());
    if (evaluation->first_fix) {
      tests::keep_results(set, {{"scans", static_cast<double>(result->rows.size())},
                                {"fixes", static_cast<double>(evaluation->fixes)},
                                {"wrong", static_cast<double>(evaluation->first_fix->wrong_fixes)},
                                {"rms_m", evaluation->first_fix->ate_rms_m}});
    }
    return *evaluation;
  }
  void SetUp() override {
    if (!std::filesystem::exists(data_folder() / "README.md")) {
      GTEST_SKIP() << "no real data at " << data_folder() << "; set SLAMSENSOR_DATA to its folder";
    }
  }
};

TEST_F(RealData, CampusTrees) {
  const Evaluation e = run("campus_trees", "");
  EXPECT_GE(static_cast<double>(e.fixes), 0.95 * static_cast<double>(e.scans_in_truth));
  ASSERT_TRUE(e.first_fix);
  EXPECT_EQ(e.first_fix->wrong_fixes, 0U);
  EXPECT_LE(e.first_fix->ate_rms_m, 0.25);
}

TEST_F(RealData, OxfordForest) {
  const Evaluation e = run("oxford_forest", "landmarks.csv");
  EXPECT_GE(static_cast<double>(e.fixes), 0.99 * static_cast<double>(e.scans_in_truth));
  ASSERT_TRUE(e.first_fix);
  EXPECT_EQ(e.first_fix->wrong_fixes, 0U);
  EXPECT_LE(e.first_fix->ate_rms_m, 0.30);
  // The error does not grow: the last half is no worse than the first, beyond what chance moves.
  double first_half = 0.0;
  double last_half = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    first_half += e.first_fix->tenths[i].rms_m / 5.0;
    last_half += e.first_fix->tenths[5 + i].rms_m / 5.0;
  }
  EXPECT_LE(last_half, 1.5 * first_half + 0.05);
}

TEST_F(RealData, VictoriaParkIsNeverWrong) {
  const Evaluation e = run("victoria_park", "landmarks.csv");
  ASSERT_TRUE(e.first_fix);
  EXPECT_EQ(e.first_fix->wrong_fixes, 0U);
  EXPECT_GE(e.fixes, 2000U);
}

/// `plot,x_m,y_m,diameter_m` by plot.
std::map<int, std::vector<core::Point2>> read_plots(const std::filesystem::path& path) {
  std::map<int, std::vector<core::Point2>> plots;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    int plot = 0;
    double x_m = 0.0;
    double y_m = 0.0;
    EXPECT_EQ(std::sscanf(line.c_str(), "%d,%lf,%lf", &plot, &x_m, &y_m), 3) << line;
    plots[plot].emplace_back(x_m, y_m);
  }
  return plots;
}

TEST_F(RealData, RiojaPlotsAllMatchTheirSurvey) {
  const auto maps = read_plots(data_folder() / "rioja_plots/map.csv");
  const auto scans = read_plots(data_folder() / "rioja_plots/scan.csv");
  ASSERT_EQ(maps.size(), 16U);
  const core::Config config = profile("rioja_plots.toml").core;
  ASSERT_EQ(config.association.tolerance_m, 0.5);
  tests::InArena<core::Localizer> localizer(config);
  std::size_t fixes = 0;
  std::size_t wrong = 0;
  for (const auto& [plot, map_W] : maps) {
    ASSERT_TRUE(localizer->set_map(map_W));
    const core::Fix fix = localizer->locate(tests::as_landmarks(scans.at(plot)), {}, {});
    const double rotation_deg = fix.pose_W.heading_rad * 180.0 / std::numbers::pi;
    std::printf("rioja plot %2d: %u of %zu trees, %.2f deg, %.2f m\n", plot, fix.matches,
                scans.at(plot).size(), rotation_deg, fix.pose_W.translation().norm());
    EXPECT_EQ(fix.status, core::FixStatus::Fix) << "plot " << plot;
    EXPECT_GE(fix.matches, 25U) << "plot " << plot;  // gated by their spread, not by the tolerance
    EXPECT_GE(rotation_deg, -11.0) << "plot " << plot;
    EXPECT_LE(rotation_deg, -7.0) << "plot " << plot;
    const bool is_fix = fix.status == core::FixStatus::Fix;
    fixes += is_fix ? 1 : 0;
    wrong += is_fix && (rotation_deg < -11.0 || rotation_deg > -7.0) ? 1 : 0;
  }
  tests::keep_results("rioja_plots", {{"scans", static_cast<double>(maps.size())},
                                      {"fixes", static_cast<double>(fixes)},
                                      {"wrong", static_cast<double>(wrong)}});
}

// Every plot against every other plot's survey. Neighbouring plots, 20 m apart, share trees and are rightly
// found in each other; all surveys are turned against all scans by the same 7 to 11 degrees, so a fix with
// another rotation is wrong.
TEST_F(RealData, RiojaPlotsAreFoundInNeighboursOnlyAsTheyLie) {
  const auto maps = read_plots(data_folder() / "rioja_plots/map.csv");
  const auto scans = read_plots(data_folder() / "rioja_plots/scan.csv");
  tests::InArena<core::Localizer> localizer(profile("rioja_plots.toml").core);
  int fixes = 0;
  for (const auto& [plot, map_W] : maps) {
    ASSERT_TRUE(localizer->set_map(map_W));
    for (const auto& [other, scan_L] : scans) {
      const core::Fix fix = localizer->locate(tests::as_landmarks(scan_L), {}, {});
      if (other != plot && fix.status == core::FixStatus::Fix) {
        ++fixes;
        const double rotation_deg = fix.pose_W.heading_rad * 180.0 / std::numbers::pi;
        EXPECT_NEAR(rotation_deg, -8.8, 2.2) << other << " in " << plot;
        EXPECT_NEAR(fix.pose_W.translation().norm(), 23.0, 8.0) << other << " in " << plot;
      }
    }
  }
  std::printf("rioja: %d fixes of one plot in another\n", fixes);
}

}  // namespace
}  // namespace slamsensor::tools
