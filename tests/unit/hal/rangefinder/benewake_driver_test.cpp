#include "hal/rangefinder/benewake_driver.hpp"

#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/hal/rangefinder/hex.hpp"
#include "tests/unit/hal/rangefinder/range_bench.hpp"
#include "tests/unit/hal/rangefinder/tf03_device.hpp"

#include <gtest/gtest.h>

#include <random>

namespace slamsensor::hal {
namespace {

using std::chrono::milliseconds;
using tests::hex_text;
using tests::kOverRange;
using tests::kRate1000;
using tests::kVersion;
using tests::RangeBench;
using tests::Tf03;

BenewakeSerialConfig serial_config() {
  BenewakeSerialConfig config;
  config.device.range.clock.tolerance_ppm = 5000.0;
  return config;
}

void connect(RangeBench& bench, Tf03& device, const BenewakeSerialConfig& config) {
  auto driver = make_benewake_serial(config, bench.link);
  ASSERT_TRUE(driver) << driver.error().message;
  bench.driver = std::move(*driver);
  bench.on_request = [&](const std::string& request) { return device.answer(request); };
  bench.on_tick = [&](int tick) { return device.tick(tick); };
}

TEST(BenewakeSerial, SetsUpATf03) {
  RangeBench bench;
  Tf03 device;
  device.sends = false;
  connect(bench, device, serial_config());
  ASSERT_TRUE(bench.run_until_ready(3000)) << bench.driver->problem();
  EXPECT_EQ(bench.writes[0].text, kVersion);
  EXPECT_TRUE(bench.was_written(kRate1000));
  EXPECT_TRUE(bench.was_written(hex_text("5A 06 4F 50 46 45")));
  EXPECT_TRUE(bench.was_written(hex_text("5A 05 07 01 67")));
  bench.run(1000);
  ASSERT_GT(bench.samples.size(), 900u);
  EXPECT_DOUBLE_EQ(bench.samples[0].range_m, 12.34);
  EXPECT_DOUBLE_EQ(bench.samples[0].strength, 1200.0);
  EXPECT_EQ(bench.driver->info().product.view(), "Benewake TF03");
  EXPECT_DOUBLE_EQ(bench.driver->info().rate_hz, 1000.0);
}

TEST(BenewakeSerial, StampIsWhenTheFrameBegan) {
  RangeBench bench;
  Tf03 device;
  connect(bench, device, serial_config());
  ASSERT_TRUE(bench.run_until_ready(3000));
  bench.run(2000);
  bench.samples.clear();
  bench.run(500);
  // Frames begin on whole milliseconds; the driver reads them up to 1 ms after their end.
  const double bias_s = to_seconds(bench.samples[0].stamp % milliseconds(1));
  for (const RangeSample& sample : bench.samples) {
    const double offset_s = to_seconds(sample.stamp % milliseconds(1));
    EXPECT_NEAR(offset_s, bias_s, 20e-6);
    EXPECT_LT(offset_s, 0.25e-3);
  }
}

TEST(BenewakeSerial, SlowReadingsDoNotWaitForTheNextOne) {
  RangeBench bench;
  Tf03 device;
  BenewakeSerialConfig config = serial_config();
  config.device.rate_hz = 5.0;
  connect(bench, device, config);
  ASSERT_TRUE(bench.run_until_ready(10'000)) << bench.driver->problem();
  bench.run(5000);
  bench.samples.clear();
  const int ticks = bench.ticks;
  while (bench.samples.empty() && bench.ticks < ticks + 1000) {
    bench.run(1);
  }
  ASSERT_FALSE(bench.samples.empty());
  EXPECT_LT(bench.now - bench.samples[0].stamp, milliseconds(60));
}

TEST(BenewakeSerial, OverRangeIsNoReturn) {
  RangeBench bench;
  Tf03 device;
  device.reading = kOverRange;
  connect(bench, device, serial_config());
  ASSERT_TRUE(bench.run_until_ready(3000));
  bench.run(200);
  ASSERT_FALSE(bench.samples.empty());
  EXPECT_EQ(bench.samples[0].echo, Echo::None);
  EXPECT_EQ(bench.samples[0].range_m, 0.0);
}

TEST(BenewakeSerial, ShortRestartShowsInTheRate) {
  RangeBench bench;
  Tf03 device;
  connect(bench, device, serial_config());
  ASSERT_TRUE(bench.run_until_ready(3000));
  bench.run(2000);
  device.power_cycle();  // back to 100 Hz without a pause
  bench.run(4000);
  EXPECT_EQ(bench.counter("rate_deviations"), 1u);
  EXPECT_EQ(device.period_ms, 1);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
}

TEST(BenewakeSerial, FindsAndChangesTheLineRate) {
  RangeBench bench;
  bench.device_baud = 921600;
  Tf03 device;
  BenewakeSerialConfig config = serial_config();
  config.policy = BenewakeSerialConfig::Baud::Change;
  connect(bench, device, config);
  bench.on_request = [&](const std::string& request) {
    if (request == hex_text("5A 08 06 00 C2 01 00 2B")) {
      bench.device_baud = 115200;
    }
    return device.answer(request);
  };
  ASSERT_TRUE(bench.run_until_ready(10000)) << bench.driver->problem();
  EXPECT_EQ(bench.link.baud(), 115200u);
}

TEST(BenewakeSerial, SilentDeviceIsLookedForUntilItComes) {
  RangeBench bench;
  Tf03 device;
  device.is_dead = true;
  connect(bench, device, serial_config());
  bench.run(5000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Starting);
  EXPECT_NE(bench.driver->problem().find("no reply"), std::string_view::npos);
  device.is_dead = false;
  EXPECT_TRUE(bench.run_until_ready(20000));
}

TEST(BenewakeSerial, ListenOnlyRelativeNeedsNoReplies) {
  RangeBench bench;
  Tf03 device;
  BenewakeSerialConfig config = serial_config();
  config.device.model = BenewakeModel::TfMini;
  config.device.rate_hz = 100.0;
  connect(bench, device, config);
  bench.on_request = [](const std::string&) { return ""; };
  ASSERT_TRUE(bench.run_until_ready(3000));
  EXPECT_TRUE(bench.writes.empty());
  bench.run(1000);
  EXPECT_GT(bench.samples.size(), 80u);
}

TEST(BenewakeSerial, FaultsOnTheLineNeverGiveAFalseDistance) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    RangeBench bench;
    Tf03 device;
    connect(bench, device, serial_config());
    ASSERT_TRUE(bench.run_until_ready(3000));
    std::mt19937 engine(seed);
    bench.on_tick = [&](int tick) {
      std::string bytes = device.tick(tick);
      const auto at = bytes.empty() ? 0 : engine() % bytes.size();
      switch (bytes.empty() ? 99 : engine() % 30) {
        case 0:
          bytes.erase(at, 1);
          break;
        case 1:
          bytes.insert(at, 1, bytes[at]);
          break;
        case 2:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << (engine() % 8)));
          break;
        default:
          break;
      }
      return bytes;
    };
    bench.run(3000);
    EXPECT_GT(bench.samples.size(), 1000u) << seed;
    for (const RangeSample& sample : bench.samples) {
      EXPECT_DOUBLE_EQ(sample.range_m, 12.34) << seed;
    }
  }
}

TEST(BenewakeSerial, StepsAskTheHeapForNothing) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "the heap cannot be watched here";
  }
  RangeBench bench;
  Tf03 device;
  connect(bench, device, serial_config());
  for (int i = 0; i < 3000; ++i) {
    bench.run(1);
    bench.now += milliseconds(1);
    bench.link.set_now(bench.now);
    const tests::NoAllocScope scope;
    bench.driver->step(bench.now);
    EXPECT_EQ(scope.heap_calls(), 0u);
  }
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
}

TEST(BenewakeConfig, WrongSettingsAreNamed) {
  tests::ScriptedLink link;
  BenewakeSerialConfig config;
  for (const double rate : {0.0, 15.0, 999.0, 20000.0, -100.0}) {
    config.device.rate_hz = rate;
    EXPECT_FALSE(make_benewake_serial(config, link)) << rate;
  }
  for (const double rate : {1.0, 9.0, 50.0, 900.0, 7000.0, 10000.0}) {
    config.device.rate_hz = rate;
    EXPECT_TRUE(make_benewake_serial(config, link)) << rate;
  }
  config.device.rate_hz = 1000.0;
  config.baud = 0;
  EXPECT_FALSE(make_benewake_serial(config, link));
}

}  // namespace
}  // namespace slamsensor::hal
