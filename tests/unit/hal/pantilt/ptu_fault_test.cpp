#include "tests/unit/hal/pantilt/ptu_bench.hpp"

#include <gmock/gmock.h>

#include <random>

namespace slamsensor::tests {
namespace {

using hal::Axis;
using hal::DeviceState;
using hal::MoveStatus;
using hal::Stamp;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Twist = std::function<std::string(std::string)>;

/// Sweeps with mishaps on some of the polls under way, and checks every position that is delivered.
class PtuFaults : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench.run_until_ready()); }

  /// A sweep from -2500 to 2500 with `mishaps`, each a second after the one before.
  std::vector<hal::AxisSample> sweep_with(const std::vector<PtuScript::Mishap>& mishaps) {
    bench.sweep(Axis::Pan, -2500, 1000);
    static_cast<void>(bench.take());
    EXPECT_EQ(bench.driver->move(Axis::Pan, bench.rad(2500), bench.rad(1000)), MoveStatus::Accepted);
    bench.run(milliseconds(300));
    for (const PtuScript::Mishap& mishap : mishaps) {
      bench.unit.mishaps.push_back(mishap);
      bench.run(seconds(1));
    }
    bench.run(seconds(10), [&] { return !bench.driver->axis(Axis::Pan).moving; });
    EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
    EXPECT_TRUE(bench.unit.mishaps.empty());
    return bench.take();
  }

  void expect_swept(const std::vector<hal::AxisSample>& samples, std::size_t at_least) {
    EXPECT_GE(samples.size(), at_least);
    expect_true(samples, bench.unit, bench.rad(1));
    EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
    EXPECT_EQ(bench.counter("restarts"), 0U);
    EXPECT_NEAR(bench.driver->axis(Axis::Pan).position_rad, bench.rad(2500), 1e-12);
  }

  PtuBench bench;
};

Twist lost_byte(std::size_t index) {
  return [index](std::string reply) {
    if (index < reply.size()) {
      reply.erase(index, 1);
    }
    return reply;
  };
}

TEST_F(PtuFaults, ALostReply) {
  expect_swept(sweep_with({{"PP", [](std::string) { return ""; }, {}}}), 150);
  EXPECT_EQ(bench.counter("timeouts"), 1U);
  EXPECT_EQ(bench.counter("resyncs"), 1U);
}

TEST_F(PtuFaults, ADoubledReply) {
  expect_swept(sweep_with({{"PP", [](std::string r) { return r + r; }, {}}}), 150);
  EXPECT_EQ(bench.counter("replies_unexpected"), 1U);
}

TEST_F(PtuFaults, AReplyThatComesAfterItsTimeout) {
  for (int late_ms : {290, 340, 400, 500, 700, 900}) {
    PtuScript::Mishap mishap{"PP", nullptr, milliseconds(late_ms)};
    expect_swept(sweep_with({mishap}), 130);
  }
}

TEST_F(PtuFaults, ADoubledReplyWhoseCopyComesWithALaterPoll) {
  for (int later_ms = 1; later_ms < 120; later_ms += 7) {
    const Twist copied = [&](std::string reply) {
      bench.link.deliver(reply, bench.now + milliseconds(10 + later_ms), 9600);
      return reply;
    };
    expect_swept(sweep_with({{"PP", copied, {}}}), 140);
  }
}

TEST_F(PtuFaults, ALostByteAnywhereInAReply) {
  for (std::size_t index = 0; index < 9; ++index) {
    expect_swept(sweep_with({{"PP", lost_byte(index), {}}, {"PP", lost_byte(index), {}}}), 120);
  }
}

TEST_F(PtuFaults, ALostDigitOrSignNearTheZero) {
  bench.sweep(Axis::Pan, -1000, 1000);
  EXPECT_EQ(bench.driver->move(Axis::Pan, bench.rad(1000), bench.rad(1000)), MoveStatus::Accepted);
  bench.run(milliseconds(960));
  for (int i = 0; i < 8; ++i) {
    bench.unit.mishaps.push_back({"PP", lost_byte(2), {}});
  }
  for (int i = 0; i < 500; ++i) {
    bench.run(milliseconds(1));
    expect_true(bench.take(), bench.unit, bench.rad(1));
  }
}

TEST_F(PtuFaults, AReplyThatBeganBeforeTheCommandWasOut) {
  const Twist copied = [&](std::string reply) {
    bench.link.deliver(reply, bench.now + milliseconds(1), 9600);
    return reply;
  };
  expect_swept(sweep_with({{"PP", copied, {}}}), 150);
}

TEST_F(PtuFaults, LimitReportsAnywhereInAReply) {
  for (std::size_t index = 0; index < 9; ++index) {
    const Twist marked = [index](std::string reply) {
      return reply.insert(std::min(index, reply.size()), "!P!T");
    };
    expect_swept(sweep_with({{"PP", marked, {}}}), 190);
  }
  EXPECT_EQ(bench.counter("limit_reports"), 18U);
  EXPECT_EQ(bench.counter("resyncs"), 0U);
}

TEST_F(PtuFaults, NoiseBetweenReplies) {
  for (const char* noise :
       {"\xff\xfe\r\n", "* 17\r\n", "*\r\n", "! Illegal argument\r\n", "independent (default)\r\n"}) {
    const Twist noisy = [noise](const std::string& reply) { return reply + noise; };
    expect_swept(sweep_with({{"PP", noisy, {}}}), 150);
  }
}

TEST_F(PtuFaults, ALineWithoutEnd) {
  const Twist endless = [](const std::string&) { return std::string(300, '7') + "\r\n"; };
  expect_swept(sweep_with({{"PP", endless, {}}}), 140);
  EXPECT_EQ(bench.counter("lines_overlong"), 1U);
}

TEST_F(PtuFaults, ALostConfirmationOfAMoveIsMadeGood) {
  for (const Twist& twist :
       {Twist([](std::string) { return ""; }), Twist([](std::string r) { return r + r; })}) {
    for (const char* command : {"PP2500", "PS700", "PS1000"}) {
      bench.unit.mishaps.push_back({command, twist, {}});
      static_cast<void>(bench.sweep(Axis::Pan, -2500, 700));
      const auto samples = bench.sweep(Axis::Pan, 2500, 1000);
      EXPECT_GE(samples.size(), 120U) << command;
      expect_swept(samples, 120);
    }
  }
  EXPECT_GE(bench.counter("moves_repeated"), 1U);
}

TEST_F(PtuFaults, EchoAndSentencesThatComeBackAreTurnedOffAgain) {
  const Twist restored = [&](const std::string& reply) {
    bench.unit.echo = true;
    bench.unit.verbose = true;
    return reply;
  };
  expect_swept(sweep_with({{"PP", restored, {}}}), 150);
  EXPECT_FALSE(bench.unit.echo);
  EXPECT_FALSE(bench.unit.verbose);
  EXPECT_EQ(bench.counter("settings_restored"), 2U);
}

TEST_F(PtuFaults, AMoveThatNeverReachedTheUnitIsGivenUp) {
  bench.sweep(Axis::Pan, 500, 1000);
  const Twist forgotten = [&](const std::string& reply) {
    bench.unit.place('P', 500);
    return reply;
  };
  bench.unit.mishaps.push_back({"PP1500", forgotten, {}});
  EXPECT_EQ(bench.driver->move(Axis::Pan, bench.rad(1500), bench.rad(1000)), MoveStatus::Accepted);
  bench.run(seconds(2));
  EXPECT_FALSE(bench.driver->axis(Axis::Pan).moving);
  EXPECT_EQ(bench.counter("moves_lost"), 1U);
  EXPECT_NEAR(bench.driver->axis(Axis::Pan).position_rad, bench.rad(500), 1e-12);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
}

TEST_F(PtuFaults, APowerCycleWithItsBannerStartsOver) {
  bench.sweep(Axis::Pan, 1000, 1000);
  bench.unit.power_cycle(bench.now, seconds(20));
  ASSERT_TRUE(bench.run(seconds(1), [&] { return bench.driver->state() == DeviceState::Starting; }));
  EXPECT_THAT(std::string(bench.driver->problem()), testing::HasSubstr("started anew by itself"));
  EXPECT_EQ(bench.driver->axis(Axis::Pan).polled, Stamp{});
  bench.run(seconds(10));
  EXPECT_EQ(bench.driver->state(), DeviceState::Starting);
  ASSERT_TRUE(bench.run_until_ready(seconds(30)));
  EXPECT_EQ(bench.driver->axis(Axis::Pan).position_rad, 0.0);
  expect_true(bench.sweep(Axis::Pan, 1500, 1000), bench.unit, bench.rad(1));
}

TEST_F(PtuFaults, APowerCycleWithoutABannerIsNoticedByThePosition) {
  bench.sweep(Axis::Pan, 1000, 1000);
  bench.unit.place('P', 0);
  static_cast<void>(bench.take());
  ASSERT_TRUE(bench.run(seconds(2), [&] { return bench.driver->state() == DeviceState::Starting; }));
  EXPECT_THAT(std::string(bench.driver->problem()), testing::HasSubstr("where no move of it ends"));
  for (const hal::AxisSample& sample : bench.take()) {
    EXPECT_TRUE(sample.axis == Axis::Tilt || sample.position_rad > bench.rad(999));
  }
  EXPECT_EQ(bench.counter("restarts"), 1U);
  ASSERT_TRUE(bench.run_until_ready());
  EXPECT_EQ(bench.driver->axis(Axis::Pan).position_rad, 0.0);
}

TEST(PtuFault, APowerCycleBackToTheDefaultRateIsFoundAgain) {
  hal::PtuConfig config;
  config.fast_baud = 38400;
  PtuBench bench(config);
  ASSERT_TRUE(bench.run_until_ready());
  bench.unit.power_cycle(bench.now, seconds(8));
  bench.run(seconds(3));
  EXPECT_EQ(bench.driver->state(), DeviceState::Starting);
  ASSERT_TRUE(bench.run_until_ready(seconds(60)));
  EXPECT_EQ(bench.link.baud(), 38400U);
}

TEST_F(PtuFaults, ASilentUnitLeadsToANewStartup) {
  bench.unit.mute_until = bench.now + seconds(6);
  ASSERT_TRUE(bench.run(seconds(5), [&] { return bench.driver->state() == DeviceState::Starting; }));
  EXPECT_THAT(std::string(bench.driver->problem()), testing::HasSubstr("command after command was lost"));
  ASSERT_TRUE(bench.run_until_ready(seconds(30)));
  EXPECT_EQ(bench.counter("restarts"), 1U);
}

class PtuStorm : public testing::TestWithParam<std::uint32_t> {};

/// One in twenty replies is torn, doubled, late, marked or gone, for a minute of sweeps: nothing false is
/// delivered, and the driver works at the end.
TEST_P(PtuStorm, DeliversNothingFalse) {
  std::mt19937 engine(GetParam());
  PtuBench bench;
  ASSERT_TRUE(bench.run_until_ready());
  const auto mishap = [&]() -> PtuScript::Mishap {
    const auto index = static_cast<std::size_t>(engine() % 8);
    switch (engine() % 5) {
      case 0:
        return {"P?", lost_byte(index), {}};
      case 1:
        return {"P?", [](std::string r) { return r + r; }, {}};
      case 2:
        return {"P?", nullptr, milliseconds(engine() % 900)};
      case 3:
        return {"P?", [index](std::string r) { return r.insert(std::min(index, r.size()), "!P"); }, {}};
      default:
        return {"P?", [](std::string) { return ""; }, {}};
    }
  };
  int target = 1500;
  for (int i = 0; i < 120; ++i) {
    bench.unit.mishaps.clear();
    bench.unit.mishaps.push_back(mishap());
    if (bench.driver->state() == DeviceState::Ready && !bench.driver->axis(Axis::Pan).moving) {
      target = -target;
      static_cast<void>(bench.driver->move(Axis::Pan, bench.rad(target), bench.rad(1000)));
    }
    bench.run(milliseconds(500), [&] {
      expect_true(bench.take(), bench.unit, bench.rad(1));
      return false;
    });
    ASSERT_FALSE(HasFailure()) << "seed " << GetParam() << " mishap " << i;
  }
  bench.unit.mishaps.clear();
  ASSERT_TRUE(bench.run_until_ready()) << "seed " << GetParam();
}

INSTANTIATE_TEST_SUITE_P(Seeds, PtuStorm, testing::Range(1U, 21U));

}  // namespace
}  // namespace slamsensor::tests
