#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

using testing::EndsWith;
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

TEST(PtuLife, ReportsInTheWordsOfItsSeries) {
  PtuBench old;
  old.ask("ED ");
  EXPECT_EQ(old.ask("XYZ PNU "), "! Illegal command\r\n! Illegal argument\r\n");
  EXPECT_EQ(old.ask("PS "), "* Desired Pan speed is 1000 positions/sec\r\n");
  PtuBench late(exact_settings(PtuKind::D300E));
  late.ask("ED ");
  EXPECT_EQ(late.ask("XYZ "), "! Illegal Command Entered\r\n");
  EXPECT_EQ(late.ask("PS "), "* Target Pan speed is 1000 positions/sec\r\n");
  EXPECT_EQ(late.ask("FT O "), "*\r\n* 30.0,86,84,85\r\n");
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
}

}  // namespace
}  // namespace slamsensor::tools
