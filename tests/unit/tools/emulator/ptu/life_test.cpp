#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

PtuSettings cold() {
  PtuSettings settings = exact_settings();
  settings.begin = PtuBegin::PowerUp;
  settings.reset_time = 4s;
  return settings;
}

TEST(PtuLife, PowersUpWithBannerAndResetAndHearsNothingMeanwhile) {
  PtuBench bench(cold());
  std::string told = bench.ask("PP ", 2s);
  told += bench.ask("PP ", 4s);
  EXPECT_THAT(told, StartsWith("\r\n\r\n### PAN-TILT CONTROLLER\r\n"));
  EXPECT_THAT(told, EndsWith("Initializing...!T!T!P!P*\r\n"));
  EXPECT_EQ(bench.ptu.dropped_bytes(), 6U);
  EXPECT_EQ(bench.ask("PP "), "PP * Current Pan position is 0\r\n");
  EXPECT_NEAR(bench.pan_steps(bench.now), 0.0, 1e-9);
}

TEST(PtuLife, TheWholeResetLastsHalfAMinute) {
  PtuSettings settings = cold();
  settings.reset_time = PtuSettings{}.reset_time;
  PtuBench bench(settings);
  bench.run_for(30s);
  EXPECT_THAT(bench.heard(), EndsWith("!T!T!P!P"));
  bench.run_for(1s);
  EXPECT_EQ(bench.heard(), "*\r\n");
}

TEST(PtuLife, WhileItCalibratesQueriesCanBeMixedWithItsReports) {
  PtuSettings settings = cold();
  settings.starting = PtuStarting::Answers;
  PtuBench bench(settings);
  bench.run_for(700ms);
  std::string told = bench.ask("ed ft ", 200ms);
  for (int i = 0; i < 40; ++i) {
    bench.type("pp ");
    bench.run_for(100ms);
    told += bench.heard();
  }
  EXPECT_THAT(told, HasSubstr("!T* "));
  EXPECT_THAT(told, HasSubstr("!P* "));
  EXPECT_THAT(bench.ask("pp10 "), "*\r\n");
}

TEST(PtuLife, WhileItCalibratesCommandsCanWait) {
  PtuSettings settings = cold();
  settings.starting = PtuStarting::Holds;
  PtuBench bench(settings);
  bench.run_for(1s);
  EXPECT_THAT(bench.ask("FT PP ", 5s), EndsWith("!P*\r\nFT *\r\nPP * 0\r\n"));
}

TEST(PtuLife, TheResetOfPowerUpCanBeChosen) {
  PtuBench bench(cold());
  bench.run_for(5s);
  EXPECT_EQ(bench.ask("RT DS "), "RT *\r\nDS *\r\n");
  EXPECT_EQ(bench.ptu.eeprom_writes(), 1U);
  bench.fault(FaultKind::PowerCycle, 1s);
  bench.run_for(5s);
  EXPECT_THAT(bench.heard(), EndsWith("Initializing...!T!T*\r\n"));
  bench.ask("RD DS ");
  bench.fault(FaultKind::PowerCycle, 1s);
  bench.run_for(2s);
  EXPECT_THAT(bench.heard(), EndsWith("Initializing...*\r\n"));
}

TEST(PtuLife, SettingsAreSavedRestoredAndFactory) {
  PtuBench bench;
  bench.ask("ED FT PS1500 DS PS500 ");
  EXPECT_EQ(bench.ask("DR PS "), "*\r\n* 1500\r\n");
  EXPECT_EQ(bench.ask("DF "), "*\r\n");
  EXPECT_EQ(bench.ask("PS "), "PS * Desired Pan speed is 1000 positions/sec\r\n");
}

TEST(PtuLife, ChangesItsLineRateAfterTheAnswer) {
  PtuBench bench;
  bench.ask("ED FT ");
  EXPECT_EQ(bench.ask("@(38400,0,T) "), "*\r\n");
  EXPECT_EQ(bench.ptu.baud(), 38400U);
  EXPECT_NE(bench.ask("PP "), "* 0\r\n");  // the host is still at 9600
  bench.port.set_host_baud(38400);
  bench.ask("   ");
  EXPECT_EQ(bench.ask("PP "), "* 0\r\n");
  EXPECT_EQ(bench.ask("@(1234,0,F) "), "! Illegal argument\r\n");
  bench.fault(FaultKind::PowerCycle, 1ms);
  EXPECT_EQ(bench.ptu.baud(), 38400U);  // T: the default from now on
  bench.fault(FaultKind::BaudReset);
  EXPECT_EQ(bench.ptu.baud(), 9600U);
}

TEST(PtuLife, CanAnswerAChangeOfItsLineRateAtTheNewRate) {
  PtuSettings settings = exact_settings();
  settings.baud_reply = PtuBaudReply::NewRate;
  PtuBench bench(settings);
  bench.ask("ED ");
  bench.type("@(19200,0,F) ");
  bench.run_for(15ms);  // the command is in, the answer not yet out
  bench.port.set_host_baud(19200);
  bench.run_for(100ms);
  EXPECT_EQ(bench.heard(), "*\r\n");
}

TEST(PtuLife, MonitorScansUntilAByteComesAndGoesHome) {
  PtuBench bench;
  bench.ask("ED FT ");
  EXPECT_EQ(bench.ask("M-500,500,-100,100 ", 600ms), "*\r\n");
  double low = 0.0;
  double high = 0.0;
  for (int i = 0; i < 100; ++i) {
    bench.run_for(50ms);
    low = std::min(low, bench.pan_steps(bench.now));
    high = std::max(high, bench.pan_steps(bench.now));
  }
  EXPECT_NEAR(low, -500.0, 60.0);
  EXPECT_NEAR(high, 500.0, 60.0);
  EXPECT_EQ(bench.ask("x", 1s), "");
  EXPECT_NEAR(bench.pan_steps(bench.now), 0.0, 1e-9);
  EXPECT_NEAR(bench.tilt_steps(bench.now), 0.0, 1e-9);
  EXPECT_EQ(bench.ask("PP "), "* 0\r\n");
  EXPECT_EQ(bench.ask("M-9000,500 M100,100 "), "! Illegal argument\r\n! Illegal argument\r\n");
}

TEST(PtuLife, TheLineEndOfTheCommandItselfDoesNotEndMonitor) {
  PtuBench bench;
  bench.ask("M\r\n", 2s);
  EXPECT_LT(bench.pan_steps(bench.now), -1500.0);
}

TEST(PtuLife, ANetworkedUnitHearsOnlyItsNumberAndCanBeFreed) {
  PtuBench bench;
  bench.ask("ED FT U5 _9 ");
  EXPECT_EQ(bench.ask("PP "), "");
  EXPECT_EQ(bench.ask("_5 PP "), "* 0\r\n");
  bench.ask("_0 ");
  std::string many;
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(bench.ask("PP "), "");
  }
  EXPECT_EQ(bench.ask("_5 ", 1s).size(), 100U);  // what it keeps
  bench.ask("_9 ");
  EXPECT_EQ(bench.ask("   _0 u0 DS PP ", 500ms), "*\r\n*\r\n* 0\r\n");
  EXPECT_EQ(bench.ask("U "), "* 0\r\n");
}

TEST(PtuLife, AnswersTheCommandsOfItsSeriesOnly) {
  PtuBench old;
  old.ask("ED FT ");
  EXPECT_EQ(old.ask("B VM IQ "), "! Illegal command\r\n! Illegal command\r\n! Illegal command\r\n");
  EXPECT_EQ(old.ask("PNU "), "! Illegal argument\r\n");
  PtuBench late(exact_settings(PtuKind::D300E));
  late.ask("ED FT ");
  EXPECT_EQ(late.ask("PXU500 LU PP600 PP500 ", 1s),
            "*\r\n*\r\n! Maximum allowable Pan position is 500\r\n*\r\n");
  EXPECT_EQ(late.ask("B0,0,500,600 A B ", 3s), "*\r\n*\r\n* 0,0,0,0\r\n");
  EXPECT_EQ(late.ask("PS TS VM "), "* 500\r\n* 600\r\n* PTU-D300E\r\n");
  EXPECT_EQ(late.ask("PH PHR PH TM O "), "* LOW\r\n*\r\n* REG\r\n* REG\r\n* 30.0,86,84,85\r\n");
}

TEST(PtuLife, AStepModeCountsAfterTheNextReset) {
  PtuSettings settings = exact_settings(PtuKind::E46_17_5);
  settings.reset_time = 1s;
  PtuBench bench(settings);
  bench.ask("ED FT ");
  EXPECT_EQ(bench.ask("WPQ WP PX "), "*\r\n* QUARTER\r\n* 6180\r\n");
  EXPECT_EQ(bench.ask("R PX PR ", 2s), "!T!T!P!P*\r\n* 12360\r\n* 46.285700\r\n");
}

TEST(PtuLife, ParsesWhatPeopleType) {
  PtuBench bench;
  bench.ask("ED FT ");
  EXPECT_EQ(bench.ask("pp+20\r"), "*\r\n");
  EXPECT_EQ(bench.ask("pP\n"), "* 20\r\n");
  EXPECT_EQ(bench.ask("PP1.5 PP-- PP12345678901 PPx "),
            "! Illegal argument\r\n! Illegal argument\r\n! Illegal argument\r\n! Illegal argument\r\n");
  EXPECT_EQ(bench.ask(std::string(300, 'q') + " ", 2s), "! Illegal command\r\n");
  EXPECT_EQ(bench.ask("   \r\n \r"), "");
  EXPECT_THAT(bench.ask("? ", 2s), HasSubstr("absolute position"));
}

}  // namespace
}  // namespace slamsensor::tools
