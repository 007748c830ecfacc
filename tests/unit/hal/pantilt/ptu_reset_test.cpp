#include "tests/unit/hal/pantilt/ptu_bench.hpp"

#include <gmock/gmock.h>

namespace slamsensor::tests {
namespace {

using hal::Axis;
using hal::DeviceState;
using hal::MoveStatus;
using hal::Stamp;
using std::chrono::seconds;
using testing::HasSubstr;

hal::PtuConfig never_reset() {
  hal::PtuConfig config;
  config.reset = hal::PtuReset::Never;
  return config;
}

TEST(PtuReset, ResetsWhenConfigured) {
  hal::PtuConfig config;
  config.reset = hal::PtuReset::Always;
  PtuBench bench(config);
  bench.unit.place('P', 700);
  bench.unit.mishaps.push_back({"R", nullptr, seconds(25)});
  ASSERT_TRUE(bench.run_until_ready(seconds(40)));
  expect_set_up(bench);
  EXPECT_EQ(bench.unit.count("R"), 1);
  EXPECT_EQ(bench.driver->axis(Axis::Pan).position_rad, 0.0);
}

TEST(PtuReset, AResetMayMissSomeOfItsReports) {
  for (const char* reply : {"!T!T!P*\r\n", "*\r\n", "!P!P*\r\n"}) {
    hal::PtuConfig config;
    config.reset = hal::PtuReset::Always;
    PtuBench bench(config);
    bench.unit.mishaps.push_back({"R", [reply](std::string) { return reply; }, seconds(5)});
    ASSERT_TRUE(bench.run_until_ready(seconds(40))) << reply;
    EXPECT_EQ(bench.unit.count("R"), 1) << reply;
  }
}

TEST(PtuReset, AResetThatFailsTwiceIsAFaultThatIsTriedAgain) {
  hal::PtuConfig config;
  config.reset = hal::PtuReset::Always;
  PtuBench bench(config);
  for (int i = 0; i < 2; ++i) {
    bench.unit.mishaps.push_back({"R", [](std::string) { return "!T! Axis Error\r\n"; }, seconds(2)});
  }
  ASSERT_TRUE(bench.run(seconds(40), [&] { return bench.driver->state() == DeviceState::Faulted; }));
  EXPECT_THAT(std::string(bench.driver->problem()), HasSubstr("reset failed"));
  EXPECT_EQ(bench.counter("resets_failed"), 2U);
  ASSERT_TRUE(bench.run_until_ready(seconds(40)));
}

/// Away from home when it was lost, at home when it is found: it reset itself meanwhile.
void lose_away_find_home(PtuBench& bench) {
  ASSERT_TRUE(bench.run_until_ready());
  static_cast<void>(bench.sweep(Axis::Pan, 700, 1000));
  bench.link.set_up(false);
  bench.run(seconds(1));
  bench.unit.place('P', 0);
  bench.unit.heard.clear();
  bench.link.set_up(true);
}

TEST(PtuReset, AUnitThatWentHomeUnseenIsResetOnce) {
  PtuBench bench;
  lose_away_find_home(bench);
  ASSERT_TRUE(bench.run_until_ready(seconds(60)));
  EXPECT_EQ(bench.unit.count("R"), 1);
}

TEST(PtuReset, AResetIsWorthNothingWhenTheUnitWasOutOfSightAfterIt) {
  PtuBench bench;
  lose_away_find_home(bench);
  ASSERT_TRUE(bench.run(seconds(60), [&] { return bench.unit.count("R") > 0; }));
  ASSERT_TRUE(bench.run(seconds(60), [&] { return bench.unit.heard.back() != "R"; }));
  bench.unit.mute_until = bench.now + seconds(5);  // another reset, for all the driver knows
  ASSERT_TRUE(bench.run_until_ready(seconds(120)));
  EXPECT_EQ(bench.unit.count("R"), 2);
}

TEST(PtuReset, AResetIsWorthNothingWhenStopsAreMetAfterIt) {
  PtuBench bench;
  lose_away_find_home(bench);
  ASSERT_TRUE(bench.run(seconds(60), [&] { return bench.unit.count("R") > 0; }));
  ASSERT_TRUE(bench.run(seconds(60), [&] { return bench.unit.heard.back() != "R"; }));
  bench.unit.say("!P", bench.now);
  ASSERT_TRUE(bench.run_until_ready(seconds(120)));
  EXPECT_EQ(bench.unit.count("R"), 2);
}

TEST(PtuReset, ResetsAUnitThatHasNoLimitsYet) {
  PtuBench bench;
  bench.unit.facts["PN"] = "0";
  bench.unit.facts["PX"] = "0";
  bench.unit.mishaps.push_back({"R",
                                [&bench](std::string reply) {
                                  bench.unit.facts["PN"] = "-3090";
                                  bench.unit.facts["PX"] = "3090";
                                  return reply;
                                },
                                seconds(3)});
  ASSERT_TRUE(bench.run_until_ready(seconds(40)));
  expect_set_up(bench);
  EXPECT_EQ(bench.unit.count("R"), 1);
}

/// The unit refuses `command` from now on.
void refuse(PtuBench& bench, const std::string& command) {
  constexpr std::size_t kMany = 5000;
  for (std::size_t i = 0; i < kMany; ++i) {
    bench.unit.mishaps.push_back(
        {command, [](const std::string&) { return "! Illegal command entered\r\n"; }});
  }
}

TEST(PtuReset, AUnitThatRefusesQueriesIsSaidToRefuseThem) {
  for (const auto& [command, text] : {std::pair("PN", "refuses queries for its limits"),
                                      {"TR", "refuses queries for its limits"},
                                      {"PP", "refuses the queries PP and TP"}}) {
    PtuBench bench(never_reset());
    refuse(bench, command);
    ASSERT_TRUE(bench.run(seconds(120), [&] { return bench.driver->state() == DeviceState::Faulted; }))
        << command;
    EXPECT_THAT(std::string(bench.driver->problem()), HasSubstr(text)) << command;
    bench.unit.mishaps.clear();
    EXPECT_TRUE(bench.run_until_ready(seconds(60))) << command;
  }
}

TEST(PtuReset, AUnitThatRefusesItsVersionIsNotCalledSilent) {
  PtuBench bench(never_reset());
  refuse(bench, "V");
  const auto is_said = [&] {
    return bench.driver->problem().find("refuses the commands") != std::string_view::npos;
  };
  EXPECT_TRUE(bench.run(seconds(120), is_said)) << bench.driver->problem();
  bench.unit.mishaps.clear();
  EXPECT_TRUE(bench.run_until_ready(seconds(60)));
}

struct Fact {
  const char* query;
  const char* value;
};

class PtuImpossibleFacts : public testing::TestWithParam<Fact> {};

TEST_P(PtuImpossibleFacts, AreAFault) {
  PtuBench bench(never_reset());
  bench.unit.facts[GetParam().query] = GetParam().value;
  ASSERT_TRUE(bench.run(seconds(20), [&] { return bench.driver->state() == DeviceState::Faulted; }));
  EXPECT_THAT(std::string(bench.driver->problem()), HasSubstr("impossible"));
  EXPECT_EQ(bench.driver->move(Axis::Pan, 0.1, 0.1), MoveStatus::NotReady);
  EXPECT_EQ(bench.unit.count("R"), 0);
  bench.unit.facts = PtuScript(bench.link).facts;
  EXPECT_TRUE(bench.run_until_ready());
}

INSTANTIATE_TEST_SUITE_P(All, PtuImpossibleFacts,
                         testing::Values(Fact{"PR", "0"}, Fact{"PR", "3601"}, Fact{"TR", "-185.1428"},
                                         Fact{"PN", "3"}, Fact{"PX", "-3"}, Fact{"PX", "30.5"},
                                         Fact{"TX", "99999999"}, Fact{"PU", "31"}, Fact{"PL", "-31"},
                                         Fact{"TB", "-1"}, Fact{"TA", "-2000"}));

TEST(PtuReset, TheNetworkRecoveryIsSentOnceAndOnlyWhenConfigured) {
  for (const auto recovery : {hal::PtuNetworkRecovery::Never, hal::PtuNetworkRecovery::WritesEeprom}) {
    hal::PtuConfig config;
    config.network_recovery = recovery;
    PtuBench bench(config);
    bench.unit.baud = 600;  // hears nothing
    bench.run(seconds(200));
    const bool wanted = recovery == hal::PtuNetworkRecovery::WritesEeprom;
    EXPECT_EQ(bench.counter("network_recoveries"), wanted ? 1U : 0U);
  }
}

TEST(PtuReset, SaysWhatIsWrongWithAConfiguration) {
  ScriptedLink link;
  hal::PtuConfig config;
  config.rates_baud.clear();
  EXPECT_THAT(hal::PtuDriver::create(config, link).error().message, HasSubstr("rates_baud"));
  config = {};
  config.poll_hz = 0.0;
  EXPECT_THAT(hal::PtuDriver::create(config, link).error().message, HasSubstr("poll_hz"));
  config = {};
  config.drain = Stamp{};
  EXPECT_THAT(hal::PtuDriver::create(config, link).error().message, HasSubstr("time-out"));
  config = {};
  config.fast_baud = 7;
  EXPECT_THAT(hal::PtuDriver::create(config, link).error().message, HasSubstr("fast_baud"));
}

}  // namespace
}  // namespace slamsensor::tests
