#include "hal/inclination/cia410.hpp"

#include "tests/support/no_alloc_scope.hpp"
#include "tests/support/scripted_can_link.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <utility>

namespace slamsensor::tests {
namespace {

using hal::DeviceState;

constexpr double kDegree = std::numbers::pi / 180.0;

/// An inclinometer as a test plays it, and the driver on the same bus.
class Bench {
 public:
  explicit Bench(const hal::Cia410Config& config = {})
      : driver(std::move(hal::Cia410Inclinometer::create(config, link).value())) {
    objects = {{0x100000, 0x0003019A}, {0x600000, 10}, {0x601000, 0}, {0x602000, 0}};
  }

  void run(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      now += std::chrono::milliseconds(1);
      link.set_now(now);
      driver->step(now);
      for (const hal::CanFrame& frame : link.take_sent()) {
        sent.push_back(frame);
        if (frame.id == 0x60A && !silent) {
          answer(frame);
        }
      }
    }
  }

  std::optional<hal::Inclination> measured() {
    run(250);
    return driver->take();
  }

  std::size_t asked(int key) const {
    return static_cast<std::size_t>(std::count_if(sent.begin(), sent.end(), [key](const hal::CanFrame& f) {
      return f.id == 0x60A && f.data[0] == 0x40 && (f.data[2] << 16 | f.data[1] << 8 | f.data[3]) == key;
    }));
  }

  std::uint64_t counter(std::string_view name) const {
    const auto all = driver->counters();
    return std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.name == name; })->value;
  }

  ScriptedCanLink link;
  std::unique_ptr<hal::Cia410Inclinometer> driver;
  std::map<int, int> objects;
  bool silent = false;
  hal::Stamp now = std::chrono::seconds(1);
  std::vector<hal::CanFrame> sent;

 private:
  void answer(const hal::CanFrame& f) {
    const int key = f.data[2] << 16 | f.data[1] << 8 | f.data[3];
    const bool known = objects.contains(key);
    const bool is_short = key == 0x601000 || key == 0x602000 || key == 0x600000;
    const auto value = static_cast<std::uint32_t>(known ? objects[key] : 0x06020000);
    hal::CanFrame reply = can_frame(
        0x58A, {known ? (is_short ? 0x4B : 0x43) : 0x80, f.data[1], f.data[2], f.data[3], 0, 0, 0, 0});
    for (std::size_t i = 0; i < (known && is_short ? 2 : 4); ++i) {
      reply.data[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
    link.deliver(reply);
  }
};

TEST(Cia410, ReadsSlopesOf16Bits) {
  Bench bench;
  bench.objects[0x601000] = -312;  // hundredths of a degree: the front up
  bench.objects[0x602000] = 245;   // the left side up
  const auto got = bench.measured();
  ASSERT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
  ASSERT_TRUE(got);
  EXPECT_NEAR(got->pitch_rad, -3.12 * kDegree, 1e-4);
  EXPECT_NEAR(got->roll_rad, 2.45 * kDegree, 1e-4);
  EXPECT_GE(got->stamp, std::chrono::seconds(1));
  EXPECT_LE(got->stamp, bench.now);
  EXPECT_FALSE(bench.driver->take());
  EXPECT_NE(std::find(bench.sent.begin(), bench.sent.end(), can_frame(0x000, {0x01, 0x0A})),
            bench.sent.end());
}

TEST(Cia410, ReadsSlopesOf32BitsWhereTheNodeHasThem) {
  Bench bench;
  bench.objects[0x600000] = 1;
  bench.objects[0x611000] = 40'001;  // thousandths; beyond 16 bits
  bench.objects[0x612000] = -5'000;
  const auto got = bench.measured();
  ASSERT_TRUE(got);
  EXPECT_EQ(bench.asked(0x601000), 0U);
  EXPECT_NEAR(std::sin(got->pitch_rad), std::sin(40.001 * kDegree), 1e-9);
  // A slope is the angle of one axis to the horizontal, not an Euler angle.
  EXPECT_NEAR(std::cos(got->pitch_rad) * std::sin(got->roll_rad), std::sin(-5.0 * kDegree), 1e-9);
}

TEST(Cia410, SensesOfTheSlopesAreSettings) {
  hal::Cia410Config config;
  config.long_slope = hal::LongSlope::FrontUp;
  config.lateral_slope = hal::LateralSlope::LeftDown;
  Bench bench(config);
  bench.objects[0x601000] = 100;
  bench.objects[0x602000] = 200;
  const auto got = bench.measured();
  ASSERT_TRUE(got);
  EXPECT_NEAR(got->pitch_rad, -1.0 * kDegree, 1e-4);
  EXPECT_NEAR(got->roll_rad, -2.0 * kDegree, 1e-4);
}

TEST(Cia410, MeasuresAtItsRate) {
  Bench bench;
  bench.run(200);
  const std::size_t before = bench.asked(0x602000);
  bench.run(1000);
  EXPECT_NEAR(static_cast<double>(bench.asked(0x602000) - before), 10.0, 1.0);
}

struct Refusal {
  const char* name;
  std::map<int, int> objects;
  std::set<int> absent;
  const char* words;
};

void PrintTo(const Refusal& refusal, std::ostream* out) {
  *out << refusal.name;
}

class Cia410Refuses : public testing::TestWithParam<Refusal> {};

TEST_P(Cia410Refuses, AndSaysWhy) {
  Bench bench;
  for (const auto& [key, value] : GetParam().objects) {
    bench.objects[key] = value;
  }
  for (const int key : GetParam().absent) {
    bench.objects.erase(key);
  }
  EXPECT_FALSE(bench.measured());
  EXPECT_EQ(bench.driver->state(), DeviceState::Faulted);
  EXPECT_NE(bench.driver->problem().find(GetParam().words), std::string_view::npos)
      << bench.driver->problem();
  EXPECT_NE(bench.driver->problem().find("node 10 on can0"), std::string_view::npos)
      << bench.driver->problem();
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Cia410Refuses,
    testing::Values(Refusal{"another profile", {{0x100000, 0x00020192}}, {}, "no CiA 410"},
                    Refusal{"no device type", {}, {0x100000}, "no CiA 410"},
                    Refusal{"no resolution", {}, {0x600000}, "resolution"},
                    Refusal{"odd resolution", {{0x600000, 7}}, {}, "resolution"},
                    Refusal{"no slope", {}, {0x601000}, "longitudinal"},
                    Refusal{"one axis", {}, {0x602000}, "two axes"},
                    Refusal{"cross-tilt value", {{0x601000, 20'000}}, {}, "cannot be"},
                    Refusal{"on its side", {{0x602000, 9'000}}, {}, "cannot be"},
                    Refusal{"both slopes", {{0x601000, 6'000}, {0x602000, 6'000}}, {}, "cannot be"}));

TEST(Cia410, SilenceIsReportedAndEnds) {
  Bench bench;
  ASSERT_TRUE(bench.measured());
  bench.silent = true;
  bench.run(2500);
  EXPECT_NE(bench.driver->state(), DeviceState::Ready);
  EXPECT_EQ(
      bench.driver->problem().find("CAN inclinometer node 10 on can0: it does not answer; check its power"),
      0U)
      << bench.driver->problem();
  static_cast<void>(bench.driver->take());
  bench.silent = false;
  bench.run(2500);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
  EXPECT_TRUE(bench.driver->take());
}

TEST(Cia410, BootUpReadsTheResolutionAgain) {
  Bench bench;
  bench.objects[0x602000] = 300;
  ASSERT_TRUE(bench.measured());
  bench.objects[0x600000] = 100;
  bench.link.deliver(can_frame(0x70A, {0x00}));
  bench.run(1);
  EXPECT_NE(bench.driver->state(), DeviceState::Ready);
  EXPECT_FALSE(bench.driver->take());
  bench.run(500);
  const auto got = bench.driver->take();
  ASSERT_TRUE(got);
  EXPECT_NEAR(got->roll_rad, 30.0 * kDegree, 1e-9);
  EXPECT_EQ(bench.counter("boot_ups"), 1U);
}

TEST(Cia410, EmergencyVoidsTheMeasurement) {
  Bench bench;
  ASSERT_TRUE(bench.measured());
  bench.run(200);
  bench.link.deliver(can_frame(0x08A, {0x00, 0x50, 0x81, 0, 0, 0, 0, 0}));
  bench.run(1);
  EXPECT_EQ(bench.driver->state(), DeviceState::Faulted);
  EXPECT_NE(bench.driver->problem().find("EMCY"), std::string_view::npos);
  EXPECT_FALSE(bench.driver->take());
  bench.run(1000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready) << "tried again";
}

TEST(Cia410, FramesThatItCannotHaveAreCounted) {
  Bench bench;
  bench.run(200);
  bench.link.deliver(can_frame(0x58A, {0x43}));
  bench.link.deliver(can_frame(0x70A, {0x05, 0x05}));
  bench.link.deliver(can_frame(0x08A, {0x00}));
  bench.run(2);
  EXPECT_EQ(bench.counter("frames_malformed"), 3U);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
}

TEST(Cia410, LosesAndFindsTheBus) {
  Bench bench;
  ASSERT_TRUE(bench.measured());
  bench.link.set_up(false);
  bench.run(5);
  EXPECT_EQ(bench.driver->state(), DeviceState::Absent);
  EXPECT_NE(bench.driver->problem().find("bus is down"), std::string_view::npos);
  bench.link.set_up(true);
  EXPECT_TRUE(bench.measured());
}

TEST(Cia410, RefusesSettingsOutOfBounds) {
  ScriptedCanLink link;
  hal::Cia410Config config;
  config.node = 0;
  EXPECT_FALSE(hal::Cia410Inclinometer::create(config, link));
  config.node = 128;
  EXPECT_FALSE(hal::Cia410Inclinometer::create(config, link));
  config = {};
  config.poll_hz = 0.0;
  EXPECT_FALSE(hal::Cia410Inclinometer::create(config, link));
}

TEST(Cia410, TakesNoMemory) {
  Bench bench;
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "the heap cannot be watched here";
  }
  bench.run(200);
  const NoAllocScope scope;
  for (int i = 0; i < 2000; ++i) {  // nobody answers: requests, repeats, problems
    bench.now += std::chrono::milliseconds(1);
    bench.driver->step(bench.now);
    static_cast<void>(bench.driver->take());
  }
  EXPECT_EQ(scope.heap_calls(), 0U);
}

}  // namespace
}  // namespace slamsensor::tests
