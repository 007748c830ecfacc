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
                                                      {a.substr(0, a.size() - 30) + b, 2U, 5U, false}}) {
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
    EXPECT_EQ(all.fixes_alike, is_whole ? scans : scans - 1) << "the tape of one scan is damaged";
    EXPECT_EQ(all.is_damaged, !is_whole);
  }
}

// The log of another sensor behind a recording took its map and results.
TEST_F(JoinedRecordings, APartWithoutScansIsToldFromThem) {
  static_cast<void>(record(scenario_of("fast.toml"), 2, "a.lcm"));
  auto log = firmware::EventLogWriter::create(folder_.path() / "foreign.lcm", firmware::ExistingFile::Refuse);
  ASSERT_TRUE(log);
  const std::vector<std::uint8_t> data(40, 7);
  ASSERT_TRUE(log->write(1, "CAMERA", data) && log->write(2, "CAMERA", data) && log->close());
  write("joined.lcm", content(folder_.path() / "a.lcm") + content(folder_.path() / "foreign.lcm"));
  const auto recordings = open_recordings(folder_.path() / "joined.lcm");
  ASSERT_TRUE(recordings) << recordings.error().message;
  ASSERT_EQ(recordings->size(), 2U);
  EXPECT_TRUE(recordings->front().has_scans());
  EXPECT_FALSE(recordings->back().has_scans());
  EXPECT_EQ(recordings->back().events, 2U);
}

}  // namespace
}  // namespace slamsensor::tools
