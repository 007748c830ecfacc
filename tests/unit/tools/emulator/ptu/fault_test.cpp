#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace slamsensor::tools {
namespace {

using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class PtuFaults : public testing::Test {
 protected:
  static PtuSettings settings() {
    PtuSettings all = exact_settings();
    all.reset_time = 2s;
    return all;
  }
  PtuFaults() { bench.ask("ED FT "); }
  PtuBench bench{settings()};
};

TEST_F(PtuFaults, PowerCycleLosesPositionAndSettings) {
  bench.ask("PP500 A PS1500 ", 1s);
  bench.fault(FaultKind::PowerCycle, 2s);
  EXPECT_EQ(bench.ask("PP ", 1900ms), "");
  EXPECT_NEAR(bench.pan_steps(bench.now), 500.0, 0.51);  // it stands where it stood
  bench.run_for(3s);
  EXPECT_THAT(bench.heard(), AllOf(StartsWith("\r\n\r\n###"), EndsWith("!T!T!P!P*\r\n")));
  EXPECT_EQ(bench.ask("PP PS "),
            "PP * Current Pan position is 0\r\nPS * Desired Pan speed is 1000 positions/sec\r\n");
  EXPECT_NEAR(bench.pan_steps(bench.now), 0.0, 1e-9);
}

TEST_F(PtuFaults, PowerCutInTheMiddleOfAnAnswerCutsIt) {
  bench.type("V ");
  bench.run_for(20ms);
  bench.fault(FaultKind::PowerCycle, 100ms);
  bench.run_for(100ms);
  EXPECT_LT(bench.heard().size(), 20U);
}

TEST_F(PtuFaults, SilenceHearsAndWorks) {
  bench.fault(FaultKind::Silence, 1s);
  EXPECT_EQ(bench.ask("PP300 ", 1s), "");
  EXPECT_EQ(bench.ask("PP "), "* 300\r\n");
}

TEST_F(PtuFaults, RepliesAreSwallowedDoubledAndLate) {
  bench.fault(FaultKind::SwallowReply);
  EXPECT_EQ(bench.ask("PP PP7 "), "*\r\n");
  bench.fault(FaultKind::DoubleReply);
  EXPECT_EQ(bench.ask("PP PP "), "* 7\r\n* 7\r\n* 7\r\n");
  bench.fault(FaultKind::LateReply, 700ms);
  EXPECT_EQ(bench.ask("PP ", 650ms), "");
  EXPECT_EQ(bench.ask("TP "), "* 7\r\n* 0\r\n");
}

TEST_F(PtuFaults, ALimitReportStandsInTheMiddleOfAReply) {
  std::set<std::size_t> places;
  for (int i = 0; i < 20; ++i) {
    bench.fault(FaultKind::LimitReport);
    std::string told = bench.ask("PP ");
    const std::size_t place = told.find('!');
    ASSERT_NE(place, std::string::npos);
    ASSERT_THAT(told.substr(place, 2), AnyOf("!P", "!T"));
    places.insert(place);
    EXPECT_EQ(told.erase(place, 2), "* 0\r\n");
  }
  EXPECT_GT(places.size(), 2U);
  EXPECT_EQ(bench.ask("PP "), "* 0\r\n");
}

TEST_F(PtuFaults, AResetThatFailsReportsTooFewLimitsAndLeavesTheAxisElsewhere) {
  bench.fault(FaultKind::ResetError);
  bench.run_for(3s);
  EXPECT_THAT(bench.heard(),
              AnyOf("!T!P!P! Tilt axis reset failed\r\n", "!T!T!P! Pan axis reset failed\r\n"));
  EXPECT_EQ(bench.ask("PP TP "), "* 0\r\n* 0\r\n");
  EXPECT_GT(std::abs(bench.pan_steps(bench.now)) + std::abs(bench.tilt_steps(bench.now)), 100.0);
  EXPECT_EQ(bench.ask("R ", 3s), "!T!T!P!P*\r\n");
  EXPECT_NEAR(bench.pan_steps(bench.now), 0.0, 1e-9);
  EXPECT_NEAR(bench.tilt_steps(bench.now), 0.0, 1e-9);
}

TEST_F(PtuFaults, MissedStepsAreInvisibleUntilTheNextReset) {
  bench.ask("PP2000 ", 1s);
  bench.fault(FaultKind::MissedSteps);
  bench.run_for(2s);
  EXPECT_EQ(bench.ask("PP "), "* 2000\r\n");
  const double missed = 2000.0 - bench.pan_steps(bench.now);
  EXPECT_GE(missed, 5.0);
  EXPECT_LE(missed, 60.0);
  EXPECT_EQ(bench.ask("PP0 A PP ", 3s), "*\r\n*\r\n* 0\r\n");
  EXPECT_NEAR(bench.pan_steps(bench.now), -missed, 1e-6);
  bench.ask("R ", 3s);
  EXPECT_NEAR(bench.pan_steps(bench.now), 0.0, 1e-9);
}

TEST_F(PtuFaults, MonitorModeScansUntilSomebodyTypes) {
  bench.fault(FaultKind::MonitorMode);
  bench.run_for(2s);
  EXPECT_LT(bench.pan_steps(bench.now), -1900.0);
  EXPECT_EQ(bench.ask(" ", 4s), "");
  EXPECT_EQ(bench.ask("PP "), "* 0\r\n");
}

TEST_F(PtuFaults, ABlockedAxisStandsWhereItIsAndSaysSo) {
  bench.ask("ED ");
  bench.ask("FT ");
  bench.ask("PP1000 ");
  bench.run_for(300ms);
  bench.ptu.inject({FaultKind::Blocked, bench.now, 5s});
  const double stuck = bench.pan_steps(bench.now);
  EXPECT_GT(stuck, 0.0);
  EXPECT_LT(stuck, 1000.0);
  bench.ask("PP-500 ");
  bench.run_for(2s);
  EXPECT_NEAR(bench.pan_steps(bench.now), stuck, 1.0);
  EXPECT_EQ(bench.ask("PP "), "* " + std::to_string(std::lround(stuck)) + "\r\n");
  bench.run_for(3s);
  bench.ask("PP-500 ");
  bench.run_for(3s);
  EXPECT_EQ(bench.ask("PP "), "* -500\r\n");
}

TEST_F(PtuFaults, LostSettingsBringEchoAndVerboseBack) {
  bench.ask("PS500 ");
  bench.fault(FaultKind::SettingsLost);
  EXPECT_EQ(bench.ask("PS "), "PS * Desired Pan speed is 1000 positions/sec\r\n");
}

TEST_F(PtuFaults, OthersAreNotKnown) {
  for (std::size_t kind = 0; kind < kFaultKinds; ++kind) {
    const auto fault = static_cast<FaultKind>(kind);
    const bool is_line = fault <= FaultKind::CableOut;
    const bool is_other_device = fault >= FaultKind::NoReturns;
    if (is_line || is_other_device) {
      EXPECT_FALSE(bench.ptu.inject({fault, bench.now, 1s})) << name_of(fault);
    }
  }
}

// All that can happen to a unit, in any order, and it still speaks its language afterwards.
TEST(PtuStorm, ComesBackAfterEveryMixOfFaultsAndIsRepeatable) {
  const std::vector<FaultKind> kinds = {
      FaultKind::PowerCycle,  FaultKind::Silence,     FaultKind::SwallowReply, FaultKind::DoubleReply,
      FaultKind::LateReply,   FaultKind::LimitReport, FaultKind::ResetError,   FaultKind::MissedSteps,
      FaultKind::MonitorMode, FaultKind::BaudReset,   FaultKind::SettingsLost, FaultKind::Noise};
  const auto run = [&](std::uint64_t seed) {
    PtuSettings settings = ptu_settings(PtuKind::D46_17_5);
    settings.reset_time = 2s;
    PtuBench bench(settings, seed);
    Random rng(seed);
    const std::vector<std::string> words = {"PP ", "PP2500 ", "A ",  "R ", "CV PS-900 ",
                                            "LD ", "DR ",     "U3 ", "S ", "H "};
    std::string all;
    for (int i = 0; i < 60; ++i) {
      bench.type(words[rng() % words.size()]);
      bench.run_for(Stamp(static_cast<Stamp::rep>(rng() % 900'000'000)));
      const FaultKind kind = kinds[rng() % kinds.size()];
      bench.port.inject({kind, bench.now, Stamp(static_cast<Stamp::rep>(rng() % 1'000'000'000))});
      all += bench.heard();
    }
    bench.run_for(20s);
    bench.ask("   ", 5s);
    bench.ask(" _0 u0 ed ft ci i le r ", 20s);
    bench.ask("u0 pp0 a ", 15s);
    EXPECT_EQ(bench.ask("pp "), "* 0\r\n") << "seed " << seed;
    return all;
  };
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::string first = run(seed);
    EXPECT_EQ(first, run(seed)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace slamsensor::tools
