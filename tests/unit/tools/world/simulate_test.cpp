#include "tools/world/simulate.hpp"

#include "core/config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

namespace slamsensor::tools {
namespace {

using core::kDegree;

class Simulate : public testing::Test {
 protected:
  void SetUp() override {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::path(testing::TempDir()) / (std::string("slamsensor_simulate_") + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "world.toml")
        << "[area]\nx_min_m = -50\nx_max_m = 50\ny_min_m = -50\ny_max_m = 50\n[trees]\ndensity_per_ha = 40\n"
           "[people]\ncount = 2\n[ground]\namplitude_m = 0.3\n";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  SimulateOptions options(const std::string& out) const {
    SimulateOptions options;
    options.world = folder_ / "world.toml";
    options.out = folder_ / out;
    options.sweep.pan_step_rad = 1.0 * kDegree;
    options.sweep.tilt_step_rad = 5.0 * kDegree;
    options.drive.stands = 3;
    return options;
  }

  std::string read(const std::filesystem::path& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    EXPECT_TRUE(file.good()) << name;
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  std::filesystem::path folder_;
};

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(Simulate, WritesScansTruthAndObjects) {
  SimulateOptions opts = options("a");
  std::uint32_t calls = 0;
  opts.on_progress = [&calls](const SimulateProgress& progress) {
    EXPECT_EQ(progress.scans_done, ++calls);
    EXPECT_EQ(progress.scans, 3U);
  };
  const auto summary = simulate(opts);
  ASSERT_TRUE(summary.has_value()) << summary.error().message;
  EXPECT_EQ(calls, 3U);
  EXPECT_EQ(summary->scans, 3U);
  EXPECT_EQ(summary->objects, 40U);
  const std::size_t per_scan = line_count(opts.sweep) * readings_per_line(opts.sweep);
  EXPECT_EQ(summary->readings, 3 * per_scan);
  EXPECT_GT(summary->returns, per_scan);
  EXPECT_EQ(lines_in(read("a/scan_0003.csv")), per_scan + 1);
  EXPECT_EQ(read("a/scan_0001.csv").substr(0, 25), "pan_deg,tilt_deg,range_m\n");
  EXPECT_EQ(lines_in(read("a/truth.tum")), 3U);
  EXPECT_EQ(read("a/truth.tum").substr(0, 2), "1 ");
  EXPECT_EQ(lines_in(read("a/stems.csv")), 41U);
}

TEST_F(Simulate, EqualOptionsGiveEqualBytes) {
  ASSERT_TRUE(simulate(options("a")).has_value());
  ASSERT_TRUE(simulate(options("b")).has_value());
  SimulateOptions other = options("c");
  other.seed = 2;
  ASSERT_TRUE(simulate(other).has_value());
  for (const char* name : {"scan_0001.csv", "scan_0003.csv", "truth.tum", "stems.csv"}) {
    EXPECT_EQ(read(std::filesystem::path("a") / name), read(std::filesystem::path("b") / name)) << name;
  }
  EXPECT_NE(read("a/truth.tum"), read("c/truth.tum"));
  EXPECT_EQ(read("a/stems.csv"), read("c/stems.csv"));
}

TEST_F(Simulate, RefusesToMixWithALongerRun) {
  SimulateOptions longer = options("a");
  longer.drive.stands = 4;
  ASSERT_TRUE(simulate(longer).has_value());
  const auto refused = simulate(options("a"));
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("scan_0004.csv"), std::string::npos);
}

TEST_F(Simulate, RefusesBadOptionsAndUnwritableFolders) {
  SimulateOptions bad = options("a");
  bad.sweep.pan_step_rad = -1.0;
  EXPECT_FALSE(simulate(bad).has_value());
  bad = options("a");
  bad.world = folder_ / "absent.toml";
  EXPECT_FALSE(simulate(bad).has_value());
  bad = options("world.toml");  // a file is in the way
  EXPECT_FALSE(simulate(bad).has_value());
}

TEST(SimulateFiles, FormatsByHand) {
  EXPECT_EQ(scan_file_name(7), "scan_0007.csv");
  EXPECT_EQ(scan_file_name(12345), "scan_12345.csv");
  EXPECT_EQ(format_scan(
                {{{90.0 * kDegree, -1.5 * kDegree, 12.3}, {0.0, -1.5 * kDegree, core::Reading::kNoReturn}}}),
            "pan_deg,tilt_deg,range_m\n90.00000,-1.50000,12.300\n0.00000,-1.50000,\n");
  const World flat = *World::create({});
  EXPECT_EQ(format_truth(flat, {}, std::vector<Stand>{{{1.0, 2.0, 90.0 * kDegree}, 0.0}}),
            "1 1.000000 2.000000 1.500000 0.000000000 0.000000000 0.707106781 0.707106781\n");
}

}  // namespace
}  // namespace slamsensor::tools
