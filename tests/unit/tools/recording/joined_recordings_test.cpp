#include "tests/unit/tools/recording/recording_bench.hpp"

#include <gtest/gtest.h>

#include <tuple>
#include <utility>

namespace slamsensor::tools {
namespace {

using JoinedRecordings = RecordReplay;

TEST_F(JoinedRecordings, AreAllReplayed) {
  static_cast<void>(record(scenario_of("fast.toml"), 2, "a.lcm"));
  Scenario other = scenario_of("fast.toml");
  other.seed += 1;
  static_cast<void>(record(other, 3, "b.lcm"));
  const std::string a = content(folder_.path() / "a.lcm");
  const std::string b = content(folder_.path() / "b.lcm");
  for (const auto& [bytes, parts, scans, is_whole] : {std::tuple(a + b, 2U, 5U, true),
                                                      {a + b + a, 3U, 7U, true},
                                                      {a.substr(0, a.size() - 30) + b, 2U, 4U, false}}) {
    write("joined.lcm", bytes);
    const auto recordings = open_recordings(folder_.path() / "joined.lcm");
    ASSERT_TRUE(recordings) << recordings.error().message;
    ASSERT_EQ(recordings->size(), parts);
    Replay all;
    for (const RecordingFile& recording : *recordings) {
      auto replayed = replay_recording(recording, settings_of(recording));
      ASSERT_TRUE(replayed) << replayed.error().message;
      all = joined(std::move(all), std::move(*replayed));
    }
    EXPECT_EQ(all.rows.size(), scans);
    EXPECT_EQ(all.fixes_alike, scans);
    EXPECT_EQ(all.is_damaged, !is_whole);
  }
}

}  // namespace
}  // namespace slamsensor::tools
