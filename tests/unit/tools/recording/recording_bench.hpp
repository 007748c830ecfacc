#pragma once

#include "firmware/config/list_config.hpp"
#include "tests/support/source_tree.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"
#include "tools/recording/record.hpp"
#include "tools/replay/replay.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace slamsensor::tools {

inline Scenario scenario_of(const std::string& name) {
  const auto folder = tests::source_tree() / "config/scenarios";
  auto scenario = load_scenario(folder / name);
  EXPECT_TRUE(scenario) << scenario.error().message;
  return *scenario;
}

/// Eight lines through the trunks, few readings each.
inline firmware::Config small_config() {
  firmware::Config config;
  config.scan_head.scan.pan_min_rad = -1.0;
  config.scan_head.scan.pan_max_rad = 1.0;
  config.scan_head.scan.pan_speed_radps = 5.0;
  config.scan_head.scan.tilt_min_rad = -0.03;
  config.scan_head.scan.tilt_max_rad = 0.04;
  config.scan_head.scan.calibration_lines = 2;
  config.core.capacities.map_landmarks = 500;
  config.core.capacities.map_edges = 7000;
  return config;
}

inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline firmware::Config settings_of(const RecordingFile& recording) {
  firmware::LoadedConfig loaded;
  const auto errors = firmware::apply_config_toml(loaded, recording.config.value_or(""), "recording");
  EXPECT_TRUE(errors.empty()) << firmware::error_lines(errors);
  return loaded.config;
}

inline tl::expected<RecordingFile, InputError> first_recording(const std::filesystem::path& path) {
  return open_recordings(path).map([](const std::vector<RecordingFile>& all) { return all.front(); });
}

class RecordReplay : public testing::Test {
 protected:
  RecordSummary record(const Scenario& scenario, std::uint32_t scans, const std::string& name = "drive.lcm") {
    const auto summary = record_drive({.scenario = scenario,
                                       .config = small_config(),
                                       .out = folder_.path() / name,
                                       .scans = scans,
                                       .seconds = {}});
    EXPECT_TRUE(summary) << summary.error().message;
    return *summary;
  }
  /// With the settings in the recording.
  Replay replay_of(const std::string& name = "drive.lcm") {
    const auto recording = first_recording(folder_.path() / name);
    EXPECT_TRUE(recording) << recording.error().message;
    const auto replayed = replay_recording(*recording, settings_of(*recording));
    EXPECT_TRUE(replayed) << replayed.error().message;
    return *replayed;
  }
  void write(const std::string& name, const std::string& bytes) { folder_.write(name, bytes); }

  TempFolder folder_;
};

}  // namespace slamsensor::tools
