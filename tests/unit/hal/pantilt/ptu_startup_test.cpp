#include "tests/unit/hal/pantilt/ptu_bench.hpp"

#include <gmock/gmock.h>

namespace slamsensor::tests {
namespace {

using hal::Axis;
using hal::DeviceState;
using hal::Stamp;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::StartsWith;

TEST(PtuStartup, FromTheFactorySettings) {
  PtuBench bench;
  EXPECT_EQ(bench.driver->state(), DeviceState::Absent);
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
  EXPECT_THAT(std::string(bench.driver->info().model.view()), StartsWith("Pan-Tilt Controller v2.12.1d1"));
  EXPECT_EQ(bench.unit.count("R"), 0);
  EXPECT_LT(bench.now, seconds(103));
}

struct Manner {
  bool echo;
  bool verbose;
  const char* eol;
};

class PtuManners : public testing::TestWithParam<Manner> {};

TEST_P(PtuManners, DoNotMatter) {
  PtuBench bench;
  bench.unit.echo = GetParam().echo;
  bench.unit.verbose = GetParam().verbose;
  bench.unit.eol = GetParam().eol;
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
  EXPECT_EQ(bench.counter("resyncs"), 0U);
}

INSTANTIATE_TEST_SUITE_P(All, PtuManners,
                         testing::Values(Manner{true, true, "\r\n"}, Manner{true, false, "\r\n"},
                                         Manner{false, true, "\r\n"}, Manner{false, false, "\r\n"},
                                         Manner{true, true, "\r"}, Manner{false, false, "\r"},
                                         Manner{true, true, "\n"}, Manner{false, false, "\n"}));

class PtuRatesFound : public testing::TestWithParam<std::uint32_t> {};

TEST_P(PtuRatesFound, WhereverTheUnitWasLeft) {
  PtuBench bench;
  bench.unit.baud = GetParam();
  ASSERT_TRUE(bench.run_until_ready(seconds(30)));
  expect_set_up(bench);
  EXPECT_EQ(bench.link.baud(), GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, PtuRatesFound, testing::Values(9600, 38400, 19200, 57600, 115200));

TEST(PtuStartup, SilenceIsReportedAndTheUnitFoundWhenItComes) {
  PtuBench bench;
  bench.unit.mute_until = bench.now + seconds(40);
  bench.run(seconds(1));
  EXPECT_EQ(bench.driver->state(), DeviceState::Starting);
  EXPECT_THAT(std::string(bench.driver->problem()), HasSubstr("looking"));
  bench.run(seconds(29));
  EXPECT_THAT(std::string(bench.driver->problem()), HasSubstr("no reply at any"));
  ASSERT_TRUE(bench.run_until_ready(seconds(30)));
  expect_set_up(bench);
}

TEST(PtuStartup, WaitsOutARunningReset) {
  PtuBench bench;
  bench.unit.power_cycle(bench.now + milliseconds(400), seconds(28));
  bench.run(seconds(20));
  EXPECT_EQ(bench.driver->state(), DeviceState::Starting);
  EXPECT_THAT(std::string(bench.driver->problem()), HasSubstr("resetting"));
  EXPECT_EQ(bench.link.baud(), 9600U);
  ASSERT_TRUE(bench.run_until_ready(seconds(20)));
  expect_set_up(bench);
  EXPECT_GE(bench.counter("limit_reports"), 4U);
  EXPECT_EQ(bench.counter("power_cycles"), 1U);
}

TEST(PtuStartup, AnUnknownBannerIsNoNumber) {
  PtuBench bench;
  bench.unit.say("Distributed by somebody\r\nindependent (default) speed control mode\r\n* 17\r\n",
                 bench.now + milliseconds(500));
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
}

TEST(PtuStartup, EndsAMonitorScanAndWaitsUntilTheUnitIsHome) {
  PtuBench bench;
  bench.unit.place('P', 2000);
  bench.unit.monitor = true;
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
  EXPECT_FALSE(bench.unit.monitor);
  EXPECT_EQ(bench.driver->axis(Axis::Pan).position_rad, bench.rad(bench.unit.position('P', bench.now)));
  EXPECT_EQ(bench.unit.position('P', bench.now), bench.unit.position('P', bench.now + seconds(5)));
}

TEST(PtuStartup, EndsHalfACommand) {
  PtuBench bench;
  bench.unit.typed = "XYZ";
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
}

TEST(PtuStartup, WaitsForTheMoveThatHalfACommandBecomes) {
  PtuBench bench;
  bench.unit.typed = "PP-1500";
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
  EXPECT_EQ(bench.unit.position('P', bench.now), bench.unit.position('P', bench.now + seconds(5)));
}

TEST(PtuStartup, LeavesSlavedAndVelocityMode) {
  PtuBench bench;
  bench.unit.slaved = true;
  bench.unit.velocity = true;
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
}

TEST(PtuStartup, SettingsThatTheFirmwareDoesNotKnowAreNotNeeded) {
  PtuBench bench;
  bench.unit.mishaps.push_back({"CI", [](std::string) { return "! Illegal argument\r\n"; }, {}});
  ASSERT_TRUE(bench.run_until_ready());
  EXPECT_EQ(bench.counter("settings_refused"), 1U);
}

TEST(PtuStartup, ALostDigitDoesNotBecomeALimit) {
  PtuBench bench;
  bench.unit.mishaps.push_back({"PN", [](std::string) { return "* -390\r\n"; }, {}});
  bench.unit.mishaps.push_back({"TX", [](std::string) { return "* 60\r\n"; }, {}});
  bench.unit.mishaps.push_back({"PR", [](std::string) { return "* 18.1428\r\n"; }, {}});
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
}

TEST(PtuStartup, EachCommandMayLoseItsReplyOnce) {
  for (const char* command : {"ED", "FT", "V", "CI", "I", "H", "LE", "PP", "TP", "PR", "TA", "TX"}) {
    PtuBench bench;
    bench.unit.mishaps.push_back({command, [](std::string) { return ""; }, {}});
    ASSERT_TRUE(bench.run_until_ready()) << command;
    expect_set_up(bench);
    EXPECT_GE(bench.counter("timeouts"), 1U) << command;
  }
}

TEST(PtuStartup, EachReplyMayComeTwiceOrLate) {
  for (const char* command : {"ED", "FT", "V", "CI", "I", "H", "LE", "PP", "TP", "PR", "TA", "TX"}) {
    for (const Stamp late : {Stamp{}, Stamp(milliseconds(700))}) {
      PtuBench bench;
      bench.unit.mishaps.push_back({command, [](const std::string& reply) { return reply + reply; }, late});
      ASSERT_TRUE(bench.run_until_ready()) << command;
      expect_set_up(bench);
    }
  }
}

TEST(PtuStartup, GoesToTheFastRate) {
  hal::PtuConfig config;
  config.fast_baud = 38400;
  PtuBench bench(config);
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
  EXPECT_EQ(bench.link.baud(), 38400U);
  EXPECT_EQ(bench.unit.count("@(38400,0,F)"), 1);
}

TEST(PtuStartup, ComesBackFromAFastRateThatIsNotTaken) {
  hal::PtuConfig config;
  config.fast_baud = 38400;
  PtuBench bench(config);
  bench.unit.obeys_baud = false;
  ASSERT_TRUE(bench.run_until_ready());
  expect_set_up(bench);
  EXPECT_EQ(bench.link.baud(), 9600U);
  EXPECT_EQ(bench.counter("baud_fallbacks"), 1U);
  EXPECT_EQ(bench.unit.count("@(38400,0,F)"), 1);
}

TEST(PtuStartup, AFastRateThatIsRefusedIsLeft) {
  hal::PtuConfig config;
  config.fast_baud = 38400;
  PtuBench bench(config);
  bench.unit.mishaps.push_back({"@(38400,0,F)", [](std::string) { return "! Illegal argument\r\n"; }, {}});
  ASSERT_TRUE(bench.run_until_ready());
  EXPECT_EQ(bench.link.baud(), 9600U);
}

TEST(PtuStartup, ARateThatTheHardwareRefusesIsPassedOver) {
  PtuBench bench;
  bench.link.refuse_baud(38400);
  bench.unit.baud = 19200;
  ASSERT_TRUE(bench.run_until_ready(seconds(30)));
  EXPECT_EQ(bench.link.baud(), 19200U);
}

}  // namespace
}  // namespace slamsensor::tests
