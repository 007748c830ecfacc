// A recording of a head that leans: what its inclinometer told is on the tape, and levels the scans again.

#include "firmware/config/list_config.hpp"
#include "firmware/config/load_config.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"
#include "tests/unit/tools/recording/recording_bench.hpp"
#include "tools/recording/playback.hpp"
#include "tools/recording/record.hpp"
#include "tools/recording/recording_file.hpp"
#include "tools/replay/replay.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace slamsensor::tools {
namespace {

constexpr core::Attitude kLean{0.05, -0.03};

firmware::Config config_with(const firmware::LevellingConfig& levelling) {
  firmware::Config config;
  config.scan_head.scan.pan_min_rad = -1.0;
  config.scan_head.scan.pan_max_rad = 1.0;
  config.scan_head.scan.pan_speed_radps = 5.0;
  config.scan_head.scan.tilt_min_rad = -0.03;
  config.scan_head.scan.tilt_max_rad = 0.04;
  config.scan_head.scan.calibration_lines = 2;
  config.scan_head.levelling = levelling;
  return config;
}

class LeaningReplay : public testing::Test {
 protected:
  RecordSummary record(const firmware::LevellingConfig& levelling, const std::string& name) {
    auto scenario = load_scenario(tests::source_tree() / "config/scenarios/fast.toml");
    EXPECT_TRUE(scenario) << scenario.error().message;
    scenario->mount.roll_rad = kLean.roll_rad;
    scenario->mount.pitch_rad = kLean.pitch_rad;
    const auto summary = record_drive({.scenario = *scenario,
                                       .config = config_with(levelling),
                                       .out = folder_.path() / name,
                                       .scans = 2,
                                       .seconds = {}});
    EXPECT_TRUE(summary) << summary.error().message;
    return *summary;
  }

  std::vector<core::Reading> played(const std::string& name) {
    const auto recording = first_recording(folder_.path() / name);
    EXPECT_TRUE(recording) << recording.error().message;
    const auto chunks = open_tape(*recording);
    const auto playback = HeadPlayback::create(*chunks, settings_of(*recording));
    EXPECT_TRUE(playback) << playback.error().message;
    std::vector<core::Reading> readings;
    while (const auto event = (*playback)->next()) {
      if (const auto* line = std::get_if<firmware::Scanline>(&*event)) {
        readings.insert(readings.end(), line->readings.begin(), line->readings.end());
      }
    }
    return readings;
  }

  TempFolder folder_;
};

TEST_F(LeaningReplay, LevelsByWhatTheInclinometerReported) {
  firmware::LevellingConfig told;
  told.source = firmware::InclinationSource::Can;
  told.offset = {0.02, 0.01};
  ASSERT_EQ(record(told, "told.lcm").scans, 2U);
  firmware::LevellingConfig fixed;
  fixed.source = firmware::InclinationSource::Fixed;
  fixed.fixed = kLean;
  ASSERT_EQ(record(fixed, "fixed.lcm").scans, 2U);
  const auto by_told = played("told.lcm");
  const auto by_fixed = played("fixed.lcm");
  ASSERT_GT(by_told.size(), 1000U);
  ASSERT_EQ(by_told.size(), by_fixed.size());
  for (std::size_t i = 0; i < by_told.size(); ++i) {
    ASSERT_NEAR(by_told[i].tilt_rad, by_fixed[i].tilt_rad, 1e-6) << i;
    ASSERT_NEAR(by_told[i].pan_rad, by_fixed[i].pan_rad, 1e-6) << i;
  }
  EXPECT_NE(by_told.front().tilt_rad, by_told[100].tilt_rad) << "level tilts differ along a line";

  const auto recording = first_recording(folder_.path() / "told.lcm");
  const auto replayed = replay_recording(*recording, settings_of(*recording));
  ASSERT_TRUE(replayed) << replayed.error().message;
  EXPECT_EQ(replayed->rows.size(), 2U);
  EXPECT_EQ(replayed->fixes_compared, 2U);
  EXPECT_EQ(replayed->fixes_alike, 2U);
}

}  // namespace
}  // namespace slamsensor::tools
