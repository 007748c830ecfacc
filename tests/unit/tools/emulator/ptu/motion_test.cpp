#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace slamsensor::tools {
namespace {

PtuBench& quiet(PtuBench& bench) {
  bench.ask("ED FT ");
  return bench;
}

TEST(PtuMotion, ALineOf5000PositionsAtBaseSpeedTakes5Seconds) {
  PtuSettings settings = exact_settings();
  settings.reply_latency = {};
  PtuBench bench(settings);
  quiet(bench).ask("PP-2500 A ", 3s);
  bench.type("PP2500 A ");
  bench.run_for(6s);
  // The first '*' leaves when the move begins, 3 characters more than a '*' line ago.
  ASSERT_EQ(bench.bytes.size(), 6U);
  const Stamp begin = bench.bytes[0].at - hal::line_time(1, 9600);
  const Stamp end = bench.bytes[3].at - hal::line_time(1, 9600);
  EXPECT_EQ(end - begin, 5s);
  const Stamp quarter = begin + 1250ms;
  EXPECT_NEAR(bench.pan_steps(end), 2500.0, 1e-6);
  EXPECT_EQ(bench.heard(), "*\r\n*\r\n");
  PtuBench again(settings);
  quiet(again).ask("PP-2500 A ", 3s);
  again.type("PP2500 ");
  again.run_to(quarter);
  EXPECT_NEAR(again.pan_steps(quarter), -1250.0, 1e-5);
}

TEST(PtuMotion, ATiltStepOfTenPositionsTakes10Milliseconds) {
  PtuSettings settings = exact_settings();
  settings.reply_latency = {};
  PtuBench bench(settings);
  quiet(bench).ask("TP-350 A ", 1s);
  bench.type("TP-340 A ");
  bench.run_for(200ms);
  ASSERT_EQ(bench.bytes.size(), 6U);
  const Stamp begin = bench.bytes[0].at - hal::line_time(1, 9600);
  EXPECT_NEAR(bench.tilt_steps(begin + 5ms), -345.0, 1e-5);
  EXPECT_NEAR(bench.tilt_steps(begin + 10ms), -340.0, 1e-9);
}

TEST(PtuMotion, ReportsWholePositionsAtTheMomentOfTheQuery) {
  PtuSettings settings = exact_settings();
  settings.reply_latency = {3ms, 1ms};
  PtuBench bench(settings);
  quiet(bench).ask("PP3000 ", 100ms);
  for (int i = 0; i < 20; ++i) {
    bench.type("PP ");
    const Stamp parsed = bench.now + hal::line_time(3, 9600);
    bench.run_for(70ms);
    const double told = std::stod(bench.heard().substr(2));
    EXPECT_NEAR(told, bench.pan_steps(parsed), 0.51);
  }
}

TEST(PtuMotion, APositionLatencyMakesPositionsOlder) {
  PtuSettings settings = exact_settings();
  settings.position_latency = 20ms;
  PtuBench bench(settings);
  quiet(bench).ask("PP3000 ", 500ms);
  bench.type("PP ");
  const Stamp parsed = bench.now + hal::line_time(3, 9600);
  bench.run_for(100ms);
  EXPECT_NEAR(std::stod(bench.heard().substr(2)), bench.pan_steps(parsed - 20ms), 0.51);
}

TEST(PtuMotion, TurnsAndChangesSpeedOnTheFly) {
  PtuBench bench;
  quiet(bench).ask("PS2000 PP3000 ", 1s);
  EXPECT_EQ(bench.ask("PD ", 50ms), "* 2000\r\n");
  EXPECT_EQ(bench.ask("PS500 ", 600ms), "*\r\n");
  EXPECT_EQ(bench.ask("PD ", 50ms), "* 500\r\n");
  bench.ask("PS2902 PP-3000 ", 8s);
  EXPECT_EQ(bench.ask("PP PD "), "* -3000\r\n* 0\r\n");
}

TEST(PtuMotion, HaltsWithItsDeceleration) {
  PtuBench bench;
  quiet(bench).ask("PS2000 PP3000 TP500 ", 1s);
  bench.type("HP ");
  const Stamp parsed = bench.now + hal::line_time(3, 9600);
  bench.run_for(2s);
  EXPECT_NEAR(bench.pan_steps(bench.now) - bench.pan_steps(parsed), 750.0, 1.0);  // 2000 to 1000 at 2000/s^2
  EXPECT_EQ(bench.tilt_steps(bench.now), bench.tilt_steps(bench.now - 1s));
  EXPECT_NEAR(bench.tilt_steps(bench.now), 500.0, 1e-6);
}

TEST(PtuMotion, AwaitHoldsBackWhatFollows) {
  PtuBench bench;
  quiet(bench).ask("PP1000 ", 10ms);
  bench.type("A PP TP ");
  bench.run_for(500ms);
  EXPECT_EQ(bench.heard(), "*\r\n");  // of PP1000
  bench.run_for(700ms);
  EXPECT_EQ(bench.heard(), "*\r\n* 1000\r\n* 0\r\n");
}

TEST(PtuMotion, SlavedMovesBeginTogether) {
  PtuBench bench;
  quiet(bench).ask("S PP1000 TP500 ", 300ms);
  EXPECT_EQ(bench.ask("PP TP "), "* 0\r\n* 0\r\n");
  bench.type("A ");
  bench.run_for(300ms);
  EXPECT_GT(bench.pan_steps(bench.now), 250.0);
  EXPECT_NEAR(bench.pan_steps(bench.now), bench.tilt_steps(bench.now), 1e-6);
  bench.run_for(1s);
  EXPECT_EQ(bench.heard(), "*\r\n");
  EXPECT_EQ(bench.ask("PP500 PP ", 100ms), "*\r\n* 1000\r\n");
  bench.ask("I ", 1s);
  EXPECT_EQ(bench.ask("PP "), "* 500\r\n");
}

TEST(PtuMotion, InVelocityModeTheSignIsTheDirection) {
  PtuBench bench;
  quiet(bench).ask("CV ", 50ms);
  EXPECT_EQ(bench.ask("C "), "* pure velocity speed control mode\r\n");
  EXPECT_EQ(bench.ask("PS-500 ", 1s), "*\r\n");
  EXPECT_EQ(bench.ask("PD PS ", 50ms), "* -500\r\n* -500\r\n");
  EXPECT_LT(bench.pan_steps(bench.now), -450.0);
  EXPECT_EQ(bench.ask("PP2000 "), "*\r\n");  // without effect
  EXPECT_LT(bench.pan_steps(bench.now), -550.0);
  EXPECT_EQ(bench.ask("PS0 PD "), "*\r\n* 0\r\n");
  EXPECT_EQ(bench.ask("PS20 "), "! Motor speed cannot be less than 31 pos/sec\r\n");
  bench.ask("PS2000 ", 5s);
  EXPECT_EQ(bench.ask("PP "), "* 3090\r\n");
}

TEST(PtuMotion, RunsIntoAMechanicalStopWithoutLimits) {
  PtuBench bench;
  quiet(bench).ask("LD PP5000 ", 3s);
  bench.type("A ");
  bench.run_for(2s);
  EXPECT_EQ(bench.heard(), "!P*\r\n");  // the report stands before the answer of the command under way
  EXPECT_NEAR(bench.pan_steps(bench.now), 3290.0, 0.51);
  EXPECT_EQ(bench.ask("PP "), "* 3290\r\n");
  EXPECT_EQ(bench.ask("PP0 A PP ", 5s), "*\r\n*\r\n* 0\r\n");
}

TEST(PtuMotion, TablesAreNotChangedInMotionAndTakeTheirTime) {
  PtuSettings settings = exact_settings();
  settings.table_times.acceleration = 2s;
  PtuBench bench(settings);
  EXPECT_EQ(quiet(bench).ask("PA4000 PA ", 1900ms), "");
  bench.run_for(300ms);
  EXPECT_EQ(bench.heard(), "*\r\n* 4000\r\n");
  bench.ask("PP2000 ", 100ms);
  EXPECT_EQ(bench.ask("PB500 "), "! Illegal while axis is in motion\r\n");
  EXPECT_EQ(
      bench.ask("PS6000 PU7000 "),
      "! Pan speed cannot exceed 2902 positions/sec\r\n! Pan speed cannot exceed 5833 positions/sec\r\n");
}

TEST(PtuMotion, IndividualUnitsFindTheirLimitsBesideTheModels) {
  PtuSettings settings = exact_settings();
  settings.limit_spread = 1;
  bool differ = false;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    PtuBench bench(settings, seed);
    const std::string told = quiet(bench).ask("PX ");
    const double limit = std::stod(told.substr(2));
    EXPECT_NEAR(limit, 3090.0, 1.0) << "seed " << seed;
    differ = differ || limit != 3090.0;
    EXPECT_EQ(quiet(bench).ask("PX "), told);
  }
  EXPECT_TRUE(differ);
}

}  // namespace
}  // namespace slamsensor::tools
