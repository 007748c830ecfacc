// Bytes that come in without a reading among them are told as such, with the wrong checksums; and a stop of
// this process is not blamed on the device.
#include "hal/rangefinder/benewake_driver.hpp"
#include "tests/unit/hal/rangefinder/range_bench.hpp"
#include "tests/unit/hal/rangefinder/tf03_device.hpp"

#include <gmock/gmock.h>

#include <random>

namespace slamsensor::hal {
namespace {

using tests::RangeBench;
using tests::Tf03;

struct Unreadable : testing::Test {
  Unreadable() {
    BenewakeSerialConfig config;
    config.device.range.clock.tolerance_ppm = 5000.0;
    auto made = make_benewake_serial(config, bench.link);
    EXPECT_TRUE(made);
    bench.driver = std::move(*made);
    bench.on_request = [this](const std::string& request) { return device.answer(request); };
    bench.on_tick = [this](int tick) { return twist(device.tick(tick)); };
  }

  std::string twist(std::string frame) {
    if (is_random) {
      for (char& byte : frame) {
        byte = static_cast<char>(engine());
      }
    }
    if (has_wrong_sums && !frame.empty()) {
      frame.back() = static_cast<char>(frame.back() ^ 0x21);
    }
    return frame;
  }

  RangeBench bench;
  Tf03 device;
  bool is_random = false;
  bool has_wrong_sums = false;
  std::mt19937 engine{3};
};

TEST_F(Unreadable, WrongChecksumsAreToldWithTheirNumber) {
  ASSERT_TRUE(bench.run_until_ready(3000));
  bench.run(1000);
  has_wrong_sums = true;
  bench.run(3000);
  EXPECT_NE(bench.driver->state(), DeviceState::Ready);
  EXPECT_THAT(
      std::string(bench.driver->problem()),
      testing::MatchesRegex("[0-9]+ bytes and no valid frame \\([0-9]+ wrong checksums\\): check model "
                            "and baud rate, then the cable"));
  has_wrong_sums = false;
  ASSERT_TRUE(bench.run_until_ready(20'000));
  EXPECT_EQ(bench.driver->problem(), "");
}

TEST_F(Unreadable, RandomBytesAreTold) {
  for (const bool from_start : {true, false}) {
    is_random = from_start;
    bench.run(5000);
    is_random = true;
    bench.run(5000);
    EXPECT_THAT(std::string(bench.driver->problem()), testing::HasSubstr(" bytes and no valid frame"));
    is_random = false;
    ASSERT_TRUE(bench.run_until_ready(30'000));
  }
}

TEST_F(Unreadable, ASilentDeviceIsNotSaidToSend) {
  ASSERT_TRUE(bench.run_until_ready(3000));
  device.is_dead = true;
  bench.run(5000);
  EXPECT_THAT(std::string(bench.driver->problem()), testing::Not(testing::HasSubstr("bytes")));
}

TEST_F(Unreadable, AStopOfThisProcessIsNoOtherRate) {
  ASSERT_TRUE(bench.run_until_ready(3000));
  bench.run(1500);
  const std::uint64_t before = bench.counter("rate_deviations");
  for (const int stopped_ms : {700, 3000, 10'000, 60'000}) {
    bench.now += std::chrono::milliseconds(stopped_ms);  // what was sent meanwhile is lost
    bench.busy_until = bench.now;
    for (int i = 0; i < 4000; ++i) {
      bench.run(1);
      ASSERT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
    }
  }
  EXPECT_EQ(bench.counter("rate_deviations"), before);
  EXPECT_EQ(bench.counter("stream_silences"), 0U);
}

}  // namespace
}  // namespace slamsensor::hal
