#include "tools/replay/replay.hpp"

#include "tests/support/forest.hpp"
#include "tools/input/text_files.hpp"
#include "tools/replay/replay_report.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

namespace slamsensor::tools {
namespace {

class ReplayTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / (std::string("replay_") + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    config_.core.capacities.map_landmarks = 500;
    config_.core.capacities.map_edges = 7000;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  static std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// A landmark list of a walk through a forest, and one scan of another forest.
  std::filesystem::path walk() {
    tests::Draw draw(1);
    const tests::Forest forest = tests::make_forest(100, draw);
    const tests::Forest elsewhere = tests::make_forest(100, draw);
    std::ostringstream list;
    list << "scan,x_m,y_m,diameter_m,weight\n";
    for (int i = 0; i < 10; ++i) {
      const bool foreign = i == 6;
      for (const core::Point2& p : tests::scan_forest(
               foreign ? elsewhere : forest, {1.5 * i - 8.0, 2.0, 0.1 * i}, {40, 0.05, 1, 0.05}, draw)) {
        list << 10 * i << ',' << p.x() << ',' << p.y() << ",0.3,1\n";
      }
    }
    return write("landmarks.csv", list.str());
  }

  std::filesystem::path folder_;
  firmware::Config config_;
};

TEST_F(ReplayTest, ARowPerScanNamedAsTheInputNamesThem) {
  const auto result = replay({walk()}, config_);
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->rows.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(result->rows[i].scan, static_cast<std::int64_t>(10 * i));
    EXPECT_EQ(result->rows[i].fix.status, i == 6 ? core::FixStatus::NoFix : core::FixStatus::Fix)
        << "scan " << i;
    EXPECT_TRUE(result->rows[i].milliseconds.has_value());
  }
  EXPECT_FALSE(result->map.empty());
  EXPECT_EQ(result->map.size(), result->matched.size());
  EXPECT_EQ(result->map[0].first_scan, 0);
  for (const MapRow& row : result->map) {
    EXPECT_EQ(row.last_scan % 10, 0);
    EXPECT_NE(row.first_scan, 60);  // the foreign scan brought nothing in
  }
}

// A list of more landmarks than detection.landmarks_max was cut without a word.
TEST_F(ReplayTest, WhatHasNoRoomInAScanIsCountedAndTheSettingNamed) {
  config_.core.detection.landmarks_max = 12;
  const auto result = replay({walk()}, config_);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->left_out.scans_beyond_max, 10U);
  EXPECT_GT(result->left_out.landmarks_beyond_max, 10U);
  const std::string summary = replay_summary(*result);
  EXPECT_NE(summary.find("left out         " + std::to_string(result->left_out.landmarks_beyond_max) +
                         " landmarks in 10 scans"),
            std::string::npos)
      << summary;
  EXPECT_NE(summary.find("--set detection.landmarks_max=" + std::to_string(result->left_out.landmarks_most)),
            std::string::npos)
      << summary;
}

TEST_F(ReplayTest, RowsOfOnePlaceAndRangesOfZeroAreCounted) {
  const auto twins = replay({write("l.csv", "scan,x_m,y_m\n1,5,0\n1,5,0\n1,0,5\n1,-5,1\n")}, config_);
  ASSERT_TRUE(twins) << twins.error().message;
  EXPECT_EQ(twins->rows[0].fix.landmarks_seen, 3U);
  EXPECT_NE(replay_summary(*twins).find("counted once     1 landmarks"), std::string::npos);
  const auto zeros =
      replay({write("scan_1.csv", "pan_deg,tilt_deg,range_m\n0,0,0\n1,0,5\n2,0,-1\n")}, config_);
  ASSERT_TRUE(zeros) << zeros.error().message;
  EXPECT_NE(replay_summary(*zeros).find("no return        2 readings"), std::string::npos);
}

// A recording that was joined with the log of another sensor lost its map to that.
TEST_F(ReplayTest, APartWithoutAnyScanLeavesTheMapOfTheOneBefore) {
  const auto first = replay({walk()}, config_);
  ASSERT_TRUE(first);
  const Replay empty_behind = joined(*first, {});
  EXPECT_EQ(empty_behind.rows.size(), 10U);
  EXPECT_EQ(empty_behind.map.size(), first->map.size());
  EXPECT_EQ(empty_behind.matched.size(), first->map.size());
  EXPECT_EQ(empty_behind.path.size(), first->path.size());
  EXPECT_EQ(joined({}, *first).map.size(), first->map.size());
}

TEST_F(ReplayTest, TheSameInputGivesTheSameBytes) {
  const auto input = walk();
  for (const char* const out : {"a", "b"}) {
    const auto result = replay({input}, config_);
    ASSERT_TRUE(result);
    ASSERT_TRUE(write_replay(*result, config_, {}, std::nullopt, MeasuredTimes::Empty, folder_ / out));
  }
  for (const char* const name :
       {"trajectory.tum", "hindsight.tum", "fixes.csv", "map.csv", "track.nmea", "plot.svg"}) {
    const std::string bytes = read(folder_ / "a" / name);
    EXPECT_FALSE(bytes.empty()) << name;
    EXPECT_EQ(bytes, read(folder_ / "b" / name)) << name;
  }
}

TEST_F(ReplayTest, TrackSaysNoFixWithoutADatumAndCarriesTheLocalPose) {
  const auto result = replay({walk()}, config_);
  ASSERT_TRUE(result);
  ASSERT_TRUE(write_replay(*result, config_, {}, std::nullopt, MeasuredTimes::Empty, folder_ / "out"));
  const std::string track = read(folder_ / "out/track.nmea");
  EXPECT_NE(track.find("$PSLMA,POSE,"), std::string::npos);
  EXPECT_EQ(track.find(",N,"), track.find(",N,,"));  // no latitude anywhere
  EXPECT_EQ(track.find("HDT"), std::string::npos);
}

TEST_F(ReplayTest, ABrokenScanIsRefusedAndTheRestGoesOn) {
  const std::string good = "pan_deg,tilt_deg,range_m\n0,0,5\n1,0,5\n";
  write("scan_001.csv", good);
  write("scan_002.csv", "pan_deg,tilt_deg,range_m\n0,0,x\n");
  write("scan_003.csv", good);
  std::size_t told = 0;
  const auto result = replay({folder_}, config_, [&](std::size_t, std::size_t total, const FixRow&) {
    ++told;
    EXPECT_EQ(total, 3U);
  });
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->rows.size(), 2U);
  EXPECT_EQ(told, 2U);
  ASSERT_EQ(result->refused.size(), 1U);
  EXPECT_NE(result->refused[0].find("scan_002.csv"), std::string::npos);
  EXPECT_NE(replay_summary(*result).find("and 1 refused"), std::string::npos);
}

TEST_F(ReplayTest, TheStampInAFilesNameIsItsTimeInEveryOutput) {
  const std::string readings = "pan_deg,tilt_deg,range_m\n0,0,5\n1,0,5\n";
  write("1600000002.050000000.csv", readings);
  write("1600000001.900000000.csv", readings);
  const auto result = replay({folder_}, config_);
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->rows.size(), 2U);
  EXPECT_DOUBLE_EQ(result->rows[0].t_s, 1600000001.9);
  EXPECT_EQ(result->rows[1].fix.time.middle_utc, std::chrono::milliseconds(1'600'000'002'050));
  EXPECT_NE(replay_summary(*result).find("order            by the time stamp"), std::string::npos);
  ASSERT_TRUE(write_replay(*result, config_, {}, std::nullopt, MeasuredTimes::Empty, folder_ / "out"));
  EXPECT_NE(read(folder_ / "out/track.nmea").find(",122641.90,"), std::string::npos);
  EXPECT_NE(read(folder_ / "out/fixes.csv").find(",1600000002.05,"), std::string::npos);
}

TEST_F(ReplayTest, WhatAFolderHoldsBesideScansIsCountedAndMayMakeTheRunIncomplete) {
  const std::string readings = "pan_deg,tilt_deg,range_m\n0,0,5\n1,0,5\n";
  write("scan_1.csv", readings);
  write("truth.tum", "");
  auto result = replay({folder_}, config_);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_FALSE(is_incomplete(*result));
  EXPECT_NE(replay_summary(*result).find("entries not read 1\n"), std::string::npos);
  write("scan_2.csv", "\"pan\";\"tilt\";\"range\"\n0;0;5\n");
  result = replay({folder_}, config_);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_TRUE(is_incomplete(*result));
  EXPECT_NE(replay_summary(*result).find("entries not read 2\n"), std::string::npos);
}

// hindsight.tum says where the scans were by the map as it is at the end, the first scan included; one that
// was never known in it is not there.
TEST_F(ReplayTest, HindsightHasTheScansOfTheHomeMap) {
  const auto result = replay({walk()}, config_);
  ASSERT_TRUE(result);
  ASSERT_TRUE(write_replay(*result, config_, {}, std::nullopt, MeasuredTimes::Empty, folder_ / "out"));
  const auto hindsight = read_tum(folder_ / "out/hindsight.tum");
  ASSERT_TRUE(hindsight) << hindsight.error().message;
  ASSERT_EQ(hindsight->size(), 9U);
  const core::Pose2 origin{-8.0, 2.0, 0.0};
  std::size_t next = 0;
  for (int i = 0; i < 10; ++i) {
    if (i != 6) {
      const TimedPose& timed = (*hindsight)[next++];
      EXPECT_EQ(timed.t, 10.0 * i);
      EXPECT_TRUE(tests::is_right(timed.pose, origin.inverse() * core::Pose2{1.5 * i - 8.0, 2.0, 0.1 * i}))
          << i;
    }
  }
  EXPECT_NE(replay_summary(*result).find("in hindsight     9 scans known in the home map\n"),
            std::string::npos);
  EXPECT_NE(replay_summary(*result).find("local maps       1, whose place in the home map is not known: "),
            std::string::npos)
      << replay_summary(*result);
}

TEST_F(ReplayTest, TheDeadlineOfTheProfileCutsWithTheClockOnAlone) {
  config_.daemon.realtime.slam_deadline_s = 1e-9;
  const auto cut = replay({walk()}, config_, {}, ReplayClock::On);
  ASSERT_TRUE(cut);
  EXPECT_GT(cut->counters.searches_cut, 0U);
  EXPECT_NE(replay_summary(*cut).find("searches cut by the deadline: "), std::string::npos);
  const auto whole = replay({walk()}, config_, {}, ReplayClock::Off);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->counters.searches_cut, 0U);
}

TEST_F(ReplayTest, NothingToReplayIsAnError) {
  EXPECT_FALSE(replay({folder_}, config_));
  EXPECT_FALSE(replay({folder_ / "absent"}, config_));
}

TEST_F(ReplayTest, AFolderThatCannotBeMadeIsAnError) {
  const auto result = replay({walk()}, config_);
  ASSERT_TRUE(result);
  const auto written = write_replay(*result, config_, {}, std::nullopt, MeasuredTimes::Empty,
                                    write("file", "in the way") / "out");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("--out"), std::string::npos);
}

TEST_F(ReplayTest, SummaryCountsTheReasons) {
  const auto result = replay({walk()}, config_);
  ASSERT_TRUE(result);
  const std::string summary = replay_summary(*result);
  EXPECT_NE(summary.find("fixes            9 (90.0 %)"), std::string::npos) << summary;
  EXPECT_NE(summary.find("no_overlap         1"), std::string::npos) << summary;
}

}  // namespace
}  // namespace slamsensor::tools
