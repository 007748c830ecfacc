// Units and lines that do not do what they say: ramps other than told, an echo that stays, replies that come
// late or swapped, noise. The driver works on where it can, and says what it sees.
#include "tests/unit/hal/pantilt/ptu_bench.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace slamsensor::tests {
namespace {

using hal::Axis;
using hal::AxisDynamics;
using hal::DeviceState;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::IsEmpty;

std::string remark(const PtuBench& bench) {
  return std::string(bench.driver->remark());
}

std::string problem(const PtuBench& bench) {
  return std::string(bench.driver->problem());
}

struct FalseRamp {
  const char* name;
  AxisDynamics truth;  // positions/s, positions/s^2
  const char* told_base = "1000";
  const char* told = "20000";
};

void PrintTo(const FalseRamp& ramp, std::ostream* out) {
  *out << ramp.name;
}

class PtuFalseRamp : public testing::TestWithParam<FalseRamp> {
 protected:
  PtuFalseRamp() {
    bench.unit.ramp = GetParam().truth;
    for (const char* axis : {"P", "T"}) {
      bench.unit.facts[std::string(axis) + "A"] = GetParam().told;
      bench.unit.facts[std::string(axis) + "B"] = GetParam().told_base;
    }
  }

  PtuBench bench;
};

/// How far the profile that the driver reports of its last move is from the truth, after the best common
/// shift in time: what the pan fit of core makes of it.
double profile_error_rad(const PtuBench& bench, const hal::AxisStatus& status) {
  double best_rad = 1e9;
  for (int shift_ms = -20; shift_ms <= 160; ++shift_ms) {
    double worst_rad = 0.0;
    for (double elapsed_s = 0.0; elapsed_s < status.move.duration_s(); elapsed_s += 0.01) {
      const hal::Stamp at = status.begun + hal::from_seconds(elapsed_s) + milliseconds(shift_ms);
      const double true_rad = bench.rad(bench.unit.position('P', at));
      worst_rad = std::max(worst_rad, std::abs(status.move.position_rad(elapsed_s) - true_rad));
    }
    best_rad = std::min(best_rad, worst_rad);
  }
  return best_rad;
}

TEST_P(PtuFalseRamp, IsLearntAndToldAndNeverARestart) {
  ASSERT_TRUE(bench.run_until_ready());
  for (int sweep = 0; sweep < 8; ++sweep) {
    const auto samples = bench.sweep(Axis::Pan, sweep % 2 == 0 ? 2500 : -2500, 1944);
    expect_true(samples, bench.unit, bench.rad(1));
    EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
    if (sweep >= 3) {
      EXPECT_GT(samples.size(), 80U) << sweep;
      EXPECT_LT(profile_error_rad(bench, bench.driver->axis(Axis::Pan)), bench.rad(12)) << sweep;
    }
  }
  EXPECT_EQ(bench.counter("restarts"), 0U);
  EXPECT_EQ(bench.counter("moves_lost"), 0U);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
  EXPECT_GE(bench.counter("profiles_learnt"), 1U);
  EXPECT_THAT(remark(bench), HasSubstr("pan positions do not follow the acceleration that it tells (PA " +
                                       std::string(GetParam().told) + ", PB " + GetParam().told_base +
                                       "); what they show is used (PA "));
}

INSTANTIATE_TEST_SUITE_P(Ramps, PtuFalseRamp,
                         testing::Values(FalseRamp{"none", {8000.0, 0.0}},
                                         FalseRamp{"none_where_slow_is_told", {8000.0, 0.0}, "1000", "2000"},
                                         FalseRamp{"twice_as_steep", {1000.0, 4000.0}, "1000", "2000"},
                                         FalseRamp{"half_as_steep", {1000.0, 1000.0}, "1000", "2000"},
                                         FalseRamp{"a_tenth", {1000.0, 2000.0}},
                                         FalseRamp{"a_fortieth", {1000.0, 500.0}},
                                         FalseRamp{"base_speed_of_100", {100.0, 4000.0}, "1000", "4000"},
                                         FalseRamp{"base_speed_of_1800", {1800.0, 2000.0}, "1000", "2000"}));

TEST(PtuRamp, ATrueOneIsNeverReplaced) {
  for (const double slowness : {-0.006, 0.0, 0.006}) {
    PtuBench bench;
    bench.unit.slowness = slowness;
    ASSERT_TRUE(bench.run_until_ready());
    for (const int target : {2500, -2500, 300, -1200, 0}) {
      for (const double speed_ps : {300.0, 1000.0, 1944.0, 2900.0}) {
        bench.sweep(Axis::Pan, target, speed_ps);
        bench.sweep(Axis::Pan, 0, speed_ps);
      }
    }
    EXPECT_EQ(bench.counter("profiles_learnt"), 0U);
    EXPECT_EQ(bench.counter("restarts"), 0U);
    EXPECT_THAT(remark(bench), IsEmpty());
  }
}

TEST(PtuRamp, AnAxisThatIsBlockedOnItsWayIsNoRamp) {
  PtuBench bench;
  ASSERT_TRUE(bench.run_until_ready());
  bench.sweep(Axis::Pan, -2500, 1000);
  ASSERT_EQ(bench.driver->move(Axis::Pan, bench.rad(2500), bench.rad(1000)), hal::MoveStatus::Accepted);
  bench.run(seconds(2));
  bench.unit.place('P', bench.unit.position('P', bench.now));
  ASSERT_TRUE(bench.run(seconds(2), [&] { return bench.driver->state() == DeviceState::Starting; }));
  EXPECT_EQ(bench.counter("profiles_learnt"), 0U);
}

/// With the end of an echo: that of the command, or one that makes a line of it.
class PtuEcho : public testing::TestWithParam<char> {};

TEST_P(PtuEcho, ThatStaysIsTakenOutAndToldOnce) {
  PtuBench bench;
  bench.unit.echo_end = GetParam();
  bench.unit.keeps_echo = true;
  ASSERT_TRUE(bench.run_until_ready());
  for (const int target : {2500, -2500, 2500}) {
    const auto samples = bench.sweep(Axis::Pan, target, 1000);
    EXPECT_GT(samples.size(), 60U);
    expect_true(samples, bench.unit, bench.rad(1));
    EXPECT_NEAR(bench.driver->axis(Axis::Pan).position_rad, bench.rad(target), 1e-12);
  }
  EXPECT_EQ(bench.counter("restarts"), 0U);
  EXPECT_GT(bench.counter("echoes_stripped"), 100U);
  EXPECT_LE(bench.unit.count("ED"), 12);
  EXPECT_LE(bench.unit.count("PS1000"), 6);
  EXPECT_THAT(remark(bench), HasSubstr("commands come back although ED turned the echo off"));
  bench.unit.keeps_echo = false;
  bench.unit.echo = false;
  bench.run(seconds(2));
  EXPECT_THAT(remark(bench), IsEmpty());
}

TEST_P(PtuEcho, ThatComesBackWhileItWorksIsToldOnce) {
  PtuBench bench;
  bench.unit.echo_end = GetParam();
  ASSERT_TRUE(bench.run_until_ready());
  bench.unit.keeps_echo = true;
  bench.unit.echo = true;
  bench.unit.heard.clear();
  EXPECT_GT(bench.sweep(Axis::Pan, 2500, 1000).size(), 60U);
  EXPECT_LE(bench.unit.count("ED"), 3);
  EXPECT_EQ(bench.counter("restarts"), 0U);
  EXPECT_THAT(remark(bench), HasSubstr("commands come back"));
}

INSTANTIATE_TEST_SUITE_P(Ends, PtuEcho, testing::Values(' ', '\r'));

TEST(PtuSentences, ThatStayAreReadAsTheyAre) {
  PtuBench bench;
  bench.unit.keeps_sentences = true;
  ASSERT_TRUE(bench.run_until_ready());
  EXPECT_GT(bench.sweep(Axis::Pan, 2500, 1000).size(), 20U);
  EXPECT_LE(bench.unit.count("FT"), 12);
  EXPECT_THAT(remark(bench), HasSubstr("it answers in sentences although FT turned them off"));
}

/// Runs for a while and collects what is said while the unit is not ready.
std::string said_of(PtuBench& bench, seconds length) {
  std::string last;
  bench.run(length, [&] {
    if (bench.driver->state() != DeviceState::Ready) {
      last = problem(bench);
    }
    return false;
  });
  return last;
}

TEST(PtuLine, RepliesThatAreLateAreToldWithTheirTime) {
  for (const auto& [late, words] :
       {std::pair{milliseconds(350), "(0.4 s; "}, {milliseconds(2000), "(2.0 s; "}}) {
    for (const bool from_start : {false, true}) {
      hal::PtuConfig config;
      config.rates_baud = {9600};  // at another one nobody would hear them
      PtuBench bench(config);
      ASSERT_TRUE(from_start || bench.run_until_ready());
      bench.unit.late = late;
      const std::string said = said_of(bench, seconds(40));
      EXPECT_THAT(said, HasSubstr("replies come late " + std::string(words) + "ptu.query_timeout_s is 0.2)"));
      EXPECT_THAT(std::string(bench.driver->line_trouble()), HasSubstr("replies come late"));
      bench.unit.late = {};
      ASSERT_TRUE(bench.run_until_ready(seconds(30)));
      bench.sweep(Axis::Pan, 2500, 1000);
      bench.sweep(Axis::Pan, -2500, 1000);
      EXPECT_THAT(remark(bench), IsEmpty());
    }
  }
}

TEST(PtuLine, RepliesThatAreSwappedAreToldToBeSo) {
  PtuBench bench;
  ASSERT_TRUE(bench.run_until_ready());
  bench.unit.swaps = true;
  EXPECT_THAT(said_of(bench, seconds(20)), HasSubstr("replies do not fit the questions"));
  bench.unit.swaps = false;
  ASSERT_TRUE(bench.run_until_ready(seconds(30)));
}

TEST(PtuLine, NoiseIsToldAsNoiseWithItsBytes) {
  for (const bool instead : {false, true}) {
    PtuBench bench;
    ASSERT_TRUE(bench.run_until_ready());
    std::mt19937 engine(7);
    const auto noise = [&engine](std::size_t size) {
      std::string bytes(size, ' ');
      for (char& byte : bytes) {
        byte = static_cast<char>(engine());
      }
      return bytes;
    };
    bench.unit.twist = [&](std::string reply) {
      return instead ? noise(reply.size() + 4) : noise(120) + reply + noise(60);
    };
    EXPECT_THAT(
        said_of(bench, seconds(20)),
        testing::MatchesRegex("pan-tilt unit: line noise \\(bytes that are no replies: [0-9]+\\); check .*"));
    bench.unit.twist = nullptr;
    ASSERT_TRUE(bench.run_until_ready(seconds(30)));
  }
}

TEST(PtuLine, ASilentUnitThatComesBackIsNotBlamedForLateReplies) {
  PtuBench bench;
  ASSERT_TRUE(bench.run_until_ready());
  bench.unit.mute_until = bench.now + seconds(9);
  EXPECT_THAT(said_of(bench, seconds(9)), testing::AnyOf(HasSubstr("no reply"), HasSubstr("looking for")));
  ASSERT_TRUE(bench.run_until_ready(seconds(30)));
  EXPECT_THAT(remark(bench), IsEmpty());
}

}  // namespace
}  // namespace slamsensor::tests
