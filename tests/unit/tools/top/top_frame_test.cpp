#include "tools/top/top_frame.hpp"

#include "tests/unit/firmware/lcm/sample_reports.hpp"
#include "tools/top/canvas.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;
using testing::Not;

/// What a sensor that works has sent by the time 100 s.
TopState working() {
  TopState state("SLAMSENSOR_");
  state.started = seconds(90);
  std::array<std::uint8_t, 1400> out{};
  const auto send = [&](std::string_view channel, std::size_t size) {
    state.on_message({channel, {out.data(), size}}, seconds(100));
  };
  send("SLAMSENSOR_POSE", firmware::encode_pose(tests::sample_report(), out));
  send("POSE", firmware::encode_bot_core_pose(tests::sample_report(), out));
  send("SLAMSENSOR_STATUS", firmware::encode_status(tests::sample_status(), {}, out));
  send("SLAMSENSOR_COUNTERS",
       firmware::encode_counters(tests::sample_status(), {}, firmware::LcmStation::PanTilt, 0, out));
  const tests::SampleMap map(30);
  firmware::LcmMapView view = map.view();
  view.initialization = tests::sample_report().initialization;
  send("SLAMSENSOR_MAP", firmware::encode_map_chunk(view, 0, out));
  return state;
}

std::string frame(const TopState& state, hal::Stamp now = seconds(103)) {
  return draw_frame(state, 110, 40, now).text();
}

TEST(TopFrame, ShowsTheSensor) {
  const std::string text = frame(working());
  for (const char* part : {"state        fixed (emulated)",
                           "up           1:26 min, first fix after 15.3 s",
                           "fix          fix, scan 4294967290, 3.0 s ago",
                           "x y        12.500 m, -7.250 m",
                           "heading    157.56 deg",
                           "in map     3, home",
                           "1 sigma    0.173 m, 0.314 deg; near 0.095 m, 0.140 deg",
                           "protection 0.900 m",
                           "matches    17 of 21 seen, expected false alarms 1.5e-09",
                           "xi 5, W 7777 over 6666, 2 jumps, search share",
                           "head         scanning, held, scan 12, line 5 of 51",
                           "waiting for the rangefinder",
                           "readings   1.0 k/s, 3.1 M in all",
                           "latency    5.10 ms +- 0.10, worst wake-up 85 us",
                           "pan-tilt     ready, PTU-46-17.5, back 2 times, last in 1.2 s",
                           "rangefinder  starting",
                           "no reply at 115200 baud",
                           "slam         11 fixes of 12 scans, 3 hypotheses",
                           "to the fix 7.0 ms, worst 9.0 ms",
                           "map          orchard, 345 landmarks, revision 44, frozen",
                           "and        2 local maps with 31 landmarks",
                           "saved 31.0 s ago, changed since",
                           "m wide -|"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST(TopFrame, ShowsTheMapWithItsEndsAndTheSensorInIt) {
  TopState state("SLAMSENSOR_");
  std::array<std::uint8_t, 1400> out{};
  const std::vector<core::MapLandmark> landmarks(2);
  const std::vector<core::Point2> positions = {{0.0, 0.0}, {40.0, 20.0}};
  firmware::FixReport report = tests::sample_report();
  report.initialization = 1;
  report.fix.pose_W = {20.0, 10.0, 3.1};
  const firmware::LcmMapView map{{}, 1, 1, landmarks, positions};
  state.on_message({"SLAMSENSOR_MAP", {out.data(), firmware::encode_map_chunk(map, 0, out)}}, seconds(1));
  state.on_message({"SLAMSENSOR_POSE", {out.data(), firmware::encode_pose(report, out)}}, seconds(1));
  const Canvas canvas = draw_frame(state, 65 + 41, 2 + 12, seconds(1));
  // 41 columns for 40 m, 11 rows of 2 m each: lower left, upper right, and the middle.
  EXPECT_EQ(canvas.at(65, 12).c, '.');
  EXPECT_EQ(canvas.at(65 + 40, 2).c, '.');
  EXPECT_EQ(canvas.at(65 + 20, 7).c, '<');
  EXPECT_THAT(canvas.text(), HasSubstr("|- 41.0 m wide -|"));
}

TEST(TopFrame, SaysThatTheSensorIsSilent) {
  EXPECT_THAT(frame(TopState("SLAMSENSOR_"), seconds(7)),
              HasSubstr("nothing heard from a sensor on SLAMSENSOR_* for 7.0 s"));
  EXPECT_THAT(frame(working(), seconds(111)), Not(HasSubstr("silent")));
  EXPECT_THAT(frame(working(), seconds(113)), HasSubstr("sensor silent for 13.0 s; what follows is old"));
  TopState state = working();
  state.problem = "cannot join the group";
  EXPECT_THAT(frame(state), HasSubstr("cannot join the group"));
}

TEST(TopFrame, ShowsCountersThatCount) {
  TopState state = working();
  state.choice.page = TopPage::Counters;
  const std::string text = frame(state);
  EXPECT_THAT(text, HasSubstr("pan_tilt  (3 counters, 1 at 0)"));
  EXPECT_THAT(text, HasSubstr("  bytes_refused                             3\n"));
  EXPECT_THAT(text, Not(HasSubstr("replies_late")));
}

TEST(TopFrame, SpiesOnEveryChannel) {
  TopState state = working();
  state.on_message({"OTHER", {}}, seconds(101));
  state.choice.page = TopPage::Channels;
  state.choice.channel = 1;  // by name: OTHER, POSE, SLAMSENSOR_...
  const std::string text = frame(state);
  EXPECT_THAT(text, HasSubstr("OTHER                    -"));
  EXPECT_THAT(text, HasSubstr("POSE                     bot_core.pose_t"));
  EXPECT_THAT(text, HasSubstr("SLAMSENSOR_MAP           slamsensor.map_t"));
  EXPECT_THAT(text, HasSubstr("POSE: bot_core.pose_t, 144 bytes"));
  EXPECT_THAT(text, HasSubstr("pos                     12.5 -7.25 0"));
}

TEST(TopFrame, KeepsTheSelectedChannelOnTheScreen) {
  TopState state("S");
  for (int i = 100; i < 200; ++i) {
    const std::string name = "C" + std::to_string(i);
    state.on_message({name, {}}, seconds(1));
  }
  state.choice.page = TopPage::Channels;
  for (const std::size_t channel : {std::size_t{0}, std::size_t{50}, std::size_t{99}, std::size_t{5000}}) {
    state.choice.channel = channel;
    const Canvas canvas = draw_frame(state, 100, 20, seconds(2));
    int selected = 0;
    for (int y = 2; y < 20; ++y) {
      selected += canvas.at(0, y).style == CellStyle::Inverse ? 1 : 0;
    }
    EXPECT_EQ(selected, 1) << channel;
  }
}

TEST(TopFrame, FitsEverySize) {
  TopState state = working();
  for (const TopPage page : {TopPage::Sensor, TopPage::Counters, TopPage::Channels}) {
    state.choice.page = page;
    state.choice.first_line = 1000;
    for (int width = -1; width < 130; width += 3) {
      for (int height = -1; height < 50; ++height) {
        const Canvas canvas = draw_frame(state, width, height, seconds(103));
        EXPECT_EQ(canvas.width(), std::max(0, width));
        EXPECT_EQ(canvas.height(), std::max(0, height));
      }
    }
  }
}

TEST(TextLine, ShowsTimesAndAmounts) {
  EXPECT_EQ(duration_text(std::chrono::microseconds(850)), "850 us");
  EXPECT_EQ(duration_text(std::chrono::microseconds(7200)), "7.2 ms");
  EXPECT_EQ(duration_text(seconds(185)), "3:05 min");
  EXPECT_EQ(duration_text(std::chrono::minutes(27 * 60 + 14)), "27:14 h");
  EXPECT_EQ(duration_text(std::chrono::hours(9 * 24 + 3)), "9 d 3 h");
  EXPECT_EQ(amount_text(999.0), "999");
  EXPECT_EQ(amount_text(1234.0), "1.2 k");
  EXPECT_EQ(amount_text(34e6), "34.0 M");
  EXPECT_EQ(amount_text(340e6), "340 M");
}

}  // namespace
}  // namespace slamsensor::tools
