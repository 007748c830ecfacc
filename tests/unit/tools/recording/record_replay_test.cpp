#include "firmware/recording/event_log.hpp"
#include "tests/unit/tools/recording/recording_bench.hpp"
#include "tools/drive/byte_drive.hpp"
#include "tools/recording/playback.hpp"
#include "tools/recording/recording_file.hpp"
#include "tools/replay/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>

namespace slamsensor::tools {
namespace {

using testing::HasSubstr;

constexpr double kLimit_s = 600.0;

/// A fast head on a bad day: every fault of its scenario soon and often.
Scenario bad_day() {
  Scenario scenario = scenario_of("faults.toml");
  for (PlannedFault& fault : scenario.faults) {
    fault.at_s /= 6.0;
  }
  for (FaultRate& rate : scenario.rates) {
    rate.mean_gap_s /= 2.0;
  }
  return scenario;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expect_same(const std::vector<core::Reading>& played, const std::vector<core::Reading>& driven) {
  ASSERT_EQ(played.size(), driven.size());
  for (std::size_t i = 0; i < played.size(); ++i) {
    ASSERT_TRUE(same_bits(played[i].pan_rad, driven[i].pan_rad)) << i;
    ASSERT_TRUE(same_bits(played[i].tilt_rad, driven[i].tilt_rad)) << i;
    ASSERT_TRUE(same_bits(played[i].range_m, driven[i].range_m)) << i;
  }
}

using Scan = std::vector<std::vector<core::Reading>>;

std::vector<Scan> played_scans(const std::filesystem::path& path) {
  const auto recording = first_recording(path);
  const auto chunks = open_tape(*recording);
  const auto playback = HeadPlayback::create(*chunks, settings_of(*recording));
  EXPECT_TRUE(playback) << playback.error().message;
  std::vector<Scan> scans;
  Scan scan;
  while (const auto event = (*playback)->next()) {
    if (const auto* line = std::get_if<firmware::Scanline>(&*event)) {
      scan.emplace_back(line->readings.begin(), line->readings.end());
    } else {
      if (std::holds_alternative<firmware::ScanEnded>(*event)) {
        scans.push_back(scan);
      }
      scan.clear();
    }
  }
  EXPECT_EQ((*playback)->player().end(), TapeEnd::Complete) << (*playback)->player().end_text();
  return scans;
}

/// What a drive without taps gives.
std::vector<Scan> driven_scans(const Scenario& scenario, std::size_t count) {
  auto drive = ByteDrive::create(scenario, small_config().scan_head);
  EXPECT_TRUE(drive) << drive.error().message;
  std::vector<Scan> scans;
  while (scans.size() < count) {
    auto scan = (*drive)->next_scan(kLimit_s);
    if (!scan) {
      ADD_FAILURE() << "no scan in " << kLimit_s << " s";
      break;
    }
    scans.push_back(std::move(scan->scanlines));
  }
  return scans;
}

TEST_F(RecordReplay, ReadingsOfAFaultyHeadAreThoseOfTheDriveBitForBit) {
  const Scenario scenario = bad_day();
  SCOPED_TRACE(testing::Message() << "seed " << scenario.seed);
  const RecordSummary summary = record(scenario, 2);
  ASSERT_EQ(summary.scans, 2U) << summary.problem;
  EXPECT_GT(summary.readings, 2000U);  // 16 lines of 0.4 s at 388 Hz
  EXPECT_THAT(summary.faults, HasSubstr("fault,ptu,power_cycle"));
  const auto played = played_scans(folder_.path() / "drive.lcm");
  const auto driven = driven_scans(scenario, 2);
  ASSERT_EQ(played.size(), 2U);
  ASSERT_EQ(driven.size(), 2U);
  for (std::size_t scan = 0; scan < played.size(); ++scan) {
    ASSERT_EQ(played[scan].size(), driven[scan].size());
    for (std::size_t line = 0; line < played[scan].size(); ++line) {
      expect_same(played[scan][line], driven[scan][line]);
    }
  }
}

TEST_F(RecordReplay, FixesAreThoseOfTheDriveBitForBitAndSoIsTheFile) {
  const Scenario scenario = scenario_of("fast.toml");
  const RecordSummary summary = record(scenario, 4);
  ASSERT_EQ(summary.truth.size(), 4U) << summary.problem;
  static_cast<void>(record(scenario, 4, "again.lcm"));
  EXPECT_EQ(content(folder_.path() / "drive.lcm"), content(folder_.path() / "again.lcm"));
  const Replay replayed = replay_of();
  ASSERT_EQ(replayed.rows.size(), 4U);
  EXPECT_EQ(replayed.fixes_compared, 4U);
  EXPECT_EQ(replayed.fixes_alike, 4U);
  EXPECT_FALSE(replayed.is_damaged);
  ASSERT_EQ(replayed.notes.size(), 1U);
  EXPECT_THAT(replayed.notes[0], HasSubstr("the recording was ended"));
  EXPECT_DOUBLE_EQ(replayed.rows[2].t_s, summary.truth[2].t);
}

TEST_F(RecordReplay, ABusIsRecordedToo) {
  Scenario scenario = scenario_of("fast.toml");
  scenario.head.ptu = {.unit = PanTiltModel::CanOpen, .begin = DeviceBegin::PowerUp};
  scenario.head.rangefinder = {.unit = RangefinderModel::Tf03Can, .rate_hz = 1000.0};
  const RecordSummary summary = record(scenario, 2);
  ASSERT_EQ(summary.scans, 2U) << summary.problem;
  const Replay replayed = replay_of();
  EXPECT_EQ(replayed.fixes_alike, 2U);
  EXPECT_EQ(replayed.rows.size(), 2U);
}

TEST_F(RecordReplay, OtherSettingsOfADriverAreADivergenceThatIsReported) {
  static_cast<void>(record(scenario_of("fast.toml"), 2));
  const auto recording = first_recording(folder_.path() / "drive.lcm");
  firmware::Config config = settings_of(*recording);
  config.scan_head.scan.tilt_max_rad += 0.01;
  const auto replayed = replay_recording(*recording, config);
  ASSERT_TRUE(replayed);
  EXPECT_TRUE(replayed->is_damaged);
  EXPECT_LT(replayed->rows.size(), 2U);
  EXPECT_THAT(replayed->notes.back(), HasSubstr("the driver does"));
  config.head.rangefinder = firmware::RangefinderKind::BenewakeCan;
  const auto refused = replay_recording(*recording, config);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("does not fit the settings"));
}

/// The log again, of those of its events that `keep` wants, as it changes them.
std::string edited(const std::string& log,
                   const std::function<bool(const LogEvent& event, std::vector<std::uint8_t>& data)>& keep,
                   const std::filesystem::path& path) {
  std::istringstream stream(log);
  EventLogReader reader(stream);
  auto writer = firmware::EventLogWriter::create(path, firmware::ExistingFile::Replace);
  while (const auto event = reader.next()) {
    std::vector<std::uint8_t> data(event->data.begin(), event->data.end());
    if (keep(*event, data)) {
      EXPECT_TRUE(writer->write(event->utime_us, event->channel, data));
    }
  }
  EXPECT_TRUE(writer->close());
  return content(path);
}

// One damaged chunk lost all scans after it, though their landmarks were in the same file.
TEST_F(RecordReplay, ADamagedRecordingGivesItsGoodScansAndSaysWhatIsWrong) {
  const RecordSummary summary = record(scenario_of("fast.toml"), 4);
  const std::string whole = content(folder_.path() / "drive.lcm");
  const auto late_chunk = static_cast<std::int64_t>(summary.tape_chunks * 3 / 4);
  const auto is_late = [&](const LogEvent& event) {
    const auto block =
        event.channel == firmware::kTapeChannel ? firmware::decode_block(event.data) : std::nullopt;
    return block && block->number == late_chunk;
  };
  const auto scratch = folder_.path() / "scratch";
  const std::vector<std::pair<std::string, std::string>> damages = {
      {whole.substr(0, whole.size() * 3 / 4), "was not ended"},
      {edited(
           whole, [&](const LogEvent& event, auto&) { return !is_late(event); }, scratch),
       "chunk " + std::to_string(late_chunk) + " is missing or damaged"},
      {edited(
           whole,
           [&](const LogEvent& event, auto& data) {
             data[data.size() / 2] ^= static_cast<std::uint8_t>(is_late(event) ? 0x10 : 0);
             return true;
           },
           scratch),
       "chunk " + std::to_string(late_chunk) + " is missing or damaged"},
  };
  const Replay good = replay_of();
  ASSERT_EQ(good.rows.size(), 4U);
  for (const auto& [bytes, text] : damages) {
    write("bad.lcm", bytes);
    const Replay replayed = replay_of("bad.lcm");
    EXPECT_TRUE(replayed.is_damaged);
    EXPECT_THAT(replayed.notes.back(), HasSubstr(text));
    const bool is_cut = bytes.size() < whole.size() * 9 / 10;
    ASSERT_GE(replayed.rows.size(), is_cut ? 1U : 4U);
    ASSERT_LE(replayed.rows.size(), is_cut ? 3U : 4U);
    EXPECT_GE(replayed.fixes_alike, 1U) << "of the scans that are on the tape";
    EXPECT_EQ(replayed.rows.back().scan, good.rows[replayed.rows.size() - 1].scan);
    EXPECT_EQ(replayed.rows.back().fix.pose_W.x_m, good.rows[replayed.rows.size() - 1].fix.pose_W.x_m);
    if (!is_cut) {
      EXPECT_LT(replayed.fixes_alike, 4U);
      EXPECT_THAT(replayed.notes.front(), HasSubstr("after them are those of its recorded scan messages"));
    }
  }
}

TEST_F(RecordReplay, ALogOfTheSensorsScansIsLocalisedWithoutATape) {
  static_cast<void>(record(scenario_of("fast.toml"), 3));
  const Replay taped = replay_of();
  const auto is_scan = [](const LogEvent& event, auto&) { return event.channel == "SLAMSENSOR_SCAN"; };
  const std::string scans =
      edited(content(folder_.path() / "drive.lcm"), is_scan, folder_.path() / "scans.lcm");
  const auto recording = first_recording(folder_.path() / "scans.lcm");
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->chunks, 0);
  const auto replayed = replay_recording(*recording, small_config());
  ASSERT_TRUE(replayed);
  ASSERT_EQ(replayed->rows.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(replayed->rows[i].fix.status, taped.rows[i].fix.status);
    EXPECT_TRUE(same_bits(replayed->rows[i].fix.pose_W.x_m, taped.rows[i].fix.pose_W.x_m));
    EXPECT_TRUE(same_bits(replayed->rows[i].t_s, taped.rows[i].t_s));
  }
  write("none.lcm", scans.substr(0, 40));
  const auto none = first_recording(folder_.path() / "none.lcm");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("without scans"));
}

}  // namespace
}  // namespace slamsensor::tools
