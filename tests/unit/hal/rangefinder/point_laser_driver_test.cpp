#include "hal/rangefinder/point_laser.hpp"
#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/hal/rangefinder/range_bench.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace slamsensor::hal {
namespace {

using std::chrono::milliseconds;
using tests::RangeBench;

void connect(RangeBench& bench, PointLaserConfig config) {
  config.range.clock.tolerance_ppm = 5000.0;
  auto driver = make_point_laser(config, bench.link);
  ASSERT_TRUE(driver) << driver.error().message;
  bench.driver = std::move(*driver);
}

TEST(PointLaser, StartsAnLds70a) {
  RangeBench bench;
  bool is_measuring = false;
  connect(bench, astech_lds70a());
  bench.on_request = [&](const std::string& request) {
    is_measuring = request == "DT\r" || (is_measuring && request != "\x1B");
    return std::string();
  };
  bench.on_tick = [&](int) { return is_measuring ? std::string("D0012.345\r\n") : std::string(); };
  ASSERT_TRUE(bench.run_until_ready(3000)) << bench.driver->problem();
  ASSERT_EQ(bench.writes.size(), 3u);
  EXPECT_EQ(bench.writes[0].text, "\x1B");
  EXPECT_EQ(bench.writes[1].text, "SD 0 0\r");
  EXPECT_EQ(bench.writes[2].text, "DT\r");
  EXPECT_GE(bench.writes[2].at - bench.writes[1].at, milliseconds(100));
  bench.run(1000);
  ASSERT_GT(bench.samples.size(), 900u);
  EXPECT_NEAR(bench.samples[0].range_m, 12.345, 1e-12);
  is_measuring = false;
  bench.run(2000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
  EXPECT_EQ(bench.counter("stream_silences"), 1u);
}

TEST(PointLaser, UnverifiedLayoutSaysSo) {
  RangeBench bench;
  connect(bench, mdl_laserace_im_hr_unverified());
  EXPECT_FALSE(bench.run_until_ready(5000));
  EXPECT_NE(bench.driver->problem().find("UNVERIFIED"), std::string_view::npos);
  EXPECT_NE(bench.driver->info().product.view().find("unverified"), std::string_view::npos);
  bench.on_tick = [](int) { return "299.9\r\n"; };
  ASSERT_TRUE(bench.run_until_ready(5000));
  bench.run(200);
  ASSERT_FALSE(bench.samples.empty());
  EXPECT_NEAR(bench.samples[0].range_m, 299.9, 1e-9);
  EXPECT_DOUBLE_EQ(bench.driver->info().range_max_m, 300.0);
}

TEST(PointLaser, SlowDeviceIsServedTooInEveryFramedLayout) {
  for (const bool is_packed : {false, true}) {
    RangeBench bench;
    PointLaserConfig config;
    config.rate_hz = 10.0;
    config.record = is_packed ? PointRecord::Packed7 : PointRecord::AsciiDecimal;
    config.unit_m = is_packed ? 0.01 : 1.0;
    connect(bench, config);
    bench.on_tick = [&](int tick) {
      return tick % 100 == 0 ? std::string(is_packed ? "\x89\x52" : "12.34\r\n") : std::string();
    };
    ASSERT_TRUE(bench.run_until_ready(3000));
    bench.run(3000);
    ASSERT_GT(bench.samples.size(), 20u);
    EXPECT_NEAR(bench.samples.back().range_m, 12.34, 1e-9);
  }
}

TEST(PointLaser, SearchesTheUsualLineRatesWhenAllowed) {
  RangeBench bench;
  bench.device_baud = 460800;
  PointLaserConfig config;
  config.search = PointLaserConfig::Search::UsualBauds;
  connect(bench, config);
  bench.on_tick = [](int) { return "12.345\r\n"; };
  ASSERT_TRUE(bench.run_until_ready(10000));
  EXPECT_EQ(bench.link.baud(), 460800u);
}

TEST(PointLaser, StepsAskTheHeapForNothing) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "the heap cannot be watched here";
  }
  for (const PointRecord record : {PointRecord::AsciiDecimal, PointRecord::Packed7}) {
    RangeBench bench;
    PointLaserConfig config;
    config.record = record;
    connect(bench, config);
    bench.on_tick = [](int tick) { return tick % 5 == 0 ? "\x89\x52" : "12.345\r\n"; };
    for (int i = 0; i < 500; ++i) {
      bench.run(1);
      bench.now += milliseconds(1);
      bench.link.set_now(bench.now);
      const tests::NoAllocScope scope;
      bench.driver->step(bench.now);
      EXPECT_EQ(scope.heap_calls(), 0u);
    }
  }
}

TEST(PointLaserConfig, WrongSettingsAreNamed) {
  const auto is_wrong = [](auto&& change) {
    PointLaserConfig config;
    change(config);
    return point_laser_config_error(config).has_value();
  };
  EXPECT_FALSE(is_wrong([](PointLaserConfig&) {}));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.rate_hz = 0.0; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.baud = 0; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.unit_m = 0.0; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.offset_m = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.packed_bytes = 4; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.terminator = ""; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.width = 1000; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.decimals = 10; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.codes.resize(17); }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.texts = {{"", Echo::Fault}}; }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.set_up.resize(9); }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.start = std::string(65, 'x'); }));
  EXPECT_TRUE(is_wrong([](PointLaserConfig& c) { c.settle = std::chrono::seconds(11); }));
}

TEST(Judged, NothingButAFinitePositiveDistanceInRangeIsAReturn) {
  const RangeConfig range = {.range_max_m = 300.0, .weak_below = 40.0, .saturated_from = 1500.0};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(judged({nan, 100.0}, Strength::Known, range).echo, Echo::Fault);
  EXPECT_EQ(judged({infinity, 100.0}, Strength::Known, range).echo, Echo::Fault);
  EXPECT_EQ(judged({0.0, 100.0}, Strength::Known, range).echo, Echo::None);
  EXPECT_EQ(judged({-1.0, 100.0}, Strength::Known, range).echo, Echo::None);
  EXPECT_EQ(judged({300.1, 100.0}, Strength::Known, range).echo, Echo::None);
  EXPECT_EQ(judged({300.0, 100.0}, Strength::Known, range).echo, Echo::Return);
  EXPECT_EQ(judged({10.0, 39.0}, Strength::Known, range).echo, Echo::Weak);
  EXPECT_EQ(judged({10.0, 39.0}, Strength::Unknown, range).echo, Echo::Return);
  EXPECT_EQ(judged({10.0, 1500.0}, Strength::Known, range).echo, Echo::Saturated);
  EXPECT_EQ(judged({10.0, 1500.0}, Strength::Known, range).range_m, 0.0);
}

}  // namespace
}  // namespace slamsensor::hal
