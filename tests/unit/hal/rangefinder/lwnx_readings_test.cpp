#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/hal/rangefinder/lwnx_bench.hpp"

#include <gtest/gtest.h>

namespace slamsensor::hal {
namespace {

using std::chrono::milliseconds;
using namespace tests;  // NOLINT(google-build-using-namespace)

struct NoReturn {
  const char* product;
  std::string data;
};

class NoReturns : public testing::TestWithParam<NoReturn> {};

TEST_P(NoReturns, AreNeverADistance) {
  RangeBench bench;
  LightWare device;
  device.name = GetParam().product;
  device.reading = [](int) { return packet(44, GetParam().data); };
  device.rate_hz = device.name.rfind("GRF", 0) == 0 ? 5.0 : 388.0;
  connect(bench, device, config_at(device.name.rfind("GRF", 0) == 0 ? 5.0 : 388.0));
  ASSERT_TRUE(bench.run_until_ready(8000)) << bench.driver->problem();
  device.rate_hz = bench.driver->info().rate_hz;  // a product has its own rates
  bench.run(3000);
  ASSERT_FALSE(bench.samples.empty());
  for (const RangeSample& sample : bench.samples) {
    EXPECT_EQ(sample.echo, Echo::None);
    EXPECT_EQ(sample.range_m, 0.0);
  }
}

const NoReturn kNoReturns[] = {
    {"LW20", word16(-1) + word16(0)},        {"LW20", word16(-100) + word16(0)},
    {"LW20", word16(-1000) + word16(0)},     {"SF20", word16(0) + word16(0)},
    {"SF20", word16(-1000) + word16(0)},     {"LW24", word16(-1) + word16(0)},
    {"SF000/B", word16(-100) + word16(0)},   {"SF11/C", word16(-1) + word16(0)},
    {"SF30/D", word16(-1) + word16(0)},      {"SF45/B", word16(-1) + word16(0)},
    {"GRF-250", word32(-10) + word32(0)},    {"GRF-500", word32(-10) + word32(0)},
    {"GRF-500", word32(9000) + word32(100)},  // 900 m is beyond the range of 300 m
};

INSTANTIATE_TEST_SUITE_P(Products, NoReturns, testing::ValuesIn(kNoReturns));

TEST(LwnxReadings, GrfReportsDecimetres) {
  RangeBench bench;
  LightWare device;
  device.name = "GRF-500";
  device.rate_hz = 5.0;
  device.reading = [](int) { return packet(44, word32(1234) + word32(80)); };
  connect(bench, device, config_at(5.0));
  ASSERT_TRUE(bench.run_until_ready(5000)) << bench.driver->problem();
  bench.run(3000);
  EXPECT_EQ(device.settings[74], word32(50));
  EXPECT_EQ(device.settings[78], word32(1));
  ASSERT_FALSE(bench.samples.empty());
  EXPECT_NEAR(bench.samples[0].range_m, 123.4, 1e-9);
}

TEST(LwnxReadings, MillimetresWhereTheProductHasThem) {
  RangeBench bench;
  LightWare device;
  device.name = "SF45/B";
  device.rate_hz = 1000.0;
  device.reading = [](int) { return packet(45, word32(1234) + word32(80)); };
  LwnxConfig config = config_at(1000.0);
  config.mode = LwnxMode::ReadingsMm;
  config.baud = 921600;
  bench.device_baud = 921600;
  connect(bench, device, config);
  ASSERT_TRUE(bench.run_until_ready(3000)) << bench.driver->problem();
  bench.run(200);
  EXPECT_EQ(device.settings[66], std::string(1, '\x07'));
  EXPECT_EQ(device.settings[76], word32(1));
  ASSERT_FALSE(bench.samples.empty());
  EXPECT_NEAR(bench.samples[0].range_m, 1.234, 1e-9);
}

TEST(LwnxReadings, StrengthLimitsShowWeakAndSaturated) {
  RangeBench bench;
  LightWare device;
  int strength = 50;
  device.reading = [&](int) { return packet(44, word16(1234) + word16(strength)); };
  LwnxConfig config = config_at(388.0);
  config.range.weak_below = 10;
  config.range.saturated_from = 95;
  connect(bench, device, config);
  ASSERT_TRUE(bench.run_until_ready(3000));
  for (const auto& [value, echo] : {std::pair{9, Echo::Weak}, {10, Echo::Return}, {95, Echo::Saturated}}) {
    strength = value;
    bench.run(20);
    bench.samples.clear();
    bench.run(100);
    ASSERT_FALSE(bench.samples.empty());
    EXPECT_EQ(bench.samples[0].echo, echo) << value;
  }
}

struct Dazzled {
  const char* product;
  double rate_hz;
  Echo echo;  ///< of an echo of 120, where no limit is configured
};

class SaturatedByProduct : public testing::TestWithParam<Dazzled> {};

TEST_P(SaturatedByProduct, PerCentBeyondTheScaleIsNoDistance) {
  const Dazzled& c = GetParam();
  RangeBench bench;
  LightWare device;
  device.name = c.product;
  device.rate_hz = c.rate_hz;
  const bool is_wide = device.name.rfind("GRF", 0) == 0;
  int strength = 100;
  device.reading = [&](int) {
    return packet(44, is_wide ? word32(123) + word32(strength) : word16(1234) + word16(strength));
  };
  connect(bench, device, config_at(c.rate_hz));
  ASSERT_TRUE(bench.run_until_ready(8000)) << bench.driver->problem();
  device.rate_hz = bench.driver->info().rate_hz;
  bench.run(3000);
  for (const auto& [value, echo] : {std::pair{100, Echo::Return}, {120, c.echo}}) {
    strength = value;
    bench.run(static_cast<int>(3000.0 / c.rate_hz) + 50);
    bench.samples.clear();
    bench.run(static_cast<int>(3000.0 / c.rate_hz) + 50);
    ASSERT_FALSE(bench.samples.empty());
    EXPECT_EQ(bench.samples[0].echo, echo) << value;
    EXPECT_EQ(bench.samples[0].range_m > 0.0, echo == Echo::Return);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Products, SaturatedByProduct,
    testing::Values(Dazzled{"LW20", 388.0, Echo::Saturated}, Dazzled{"SF20", 388.0, Echo::Saturated},
                    Dazzled{"LW24", 388.0, Echo::Saturated}, Dazzled{"SF000/B", 388.0, Echo::Saturated},
                    Dazzled{"SF11/C", 388.0, Echo::Saturated}, Dazzled{"SF30/D", 312.5, Echo::Saturated},
                    Dazzled{"SF45/B", 400.0, Echo::Saturated},
                    Dazzled{"GRF-500", 5.0, Echo::Return}));  // tells its strength on no known scale

std::string raw_packet(int tick) {
  std::string data(1, static_cast<char>(200));
  for (int i = 0; i < 200; ++i) {
    data += i == 7 ? word16(-1) : word16(1000 + (tick / 10) % 50);
  }
  return packet(40, data);
}

/// An LW20 that sends 20 000 readings a second, 200 in a packet.
class LwnxRaw : public testing::Test {
 protected:
  void SetUp() override {
    bench.device_baud = 921600;
    device.rate_hz = 100.0;
    device.reading = raw_packet;
    LwnxConfig config;
    config.baud = 921600;
    config.mode = LwnxMode::RawReadings;
    connect(bench, device, config);
  }

  RangeBench bench;
  LightWare device;
};

TEST_F(LwnxRaw, ReadingsComeAt20kHz) {
  ASSERT_TRUE(bench.run_until_ready(3000)) << bench.driver->problem();
  EXPECT_TRUE(bench.was_written(hex_text("AA 81 00 46 01 0D 70")));
  EXPECT_TRUE(bench.was_written(hex_text("AA 41 01 1E 01 00 00 00 FE 8A")));
  EXPECT_DOUBLE_EQ(bench.driver->info().rate_hz, 20000.0);
  bench.run(2000);
  ASSERT_GT(bench.samples.size(), 36000u);
  EXPECT_EQ(bench.counter("readings_dropped"), 0u);
  for (std::size_t i = 400; i < bench.samples.size(); ++i) {
    EXPECT_NEAR(to_seconds(bench.samples[i].stamp - bench.samples[i - 1].stamp), 50e-6, 2e-6) << i;
    EXPECT_NE(bench.samples[i].range_m < 10.0, bench.samples[i].echo == Echo::Return);
  }
}

TEST(LwnxReadings, LineTooSlowForTheReadingsIsReported) {
  RangeBench bench;
  LightWare device;
  LwnxConfig config;
  config.mode = LwnxMode::RawReadings;
  connect(bench, device, config);
  EXPECT_FALSE(bench.run_until_ready(3000));
  EXPECT_EQ(bench.driver->state(), DeviceState::Faulted);
  EXPECT_NE(bench.driver->problem().find("line rate is too low"), std::string_view::npos);
}

TEST_F(LwnxRaw, ReadingsThatNobodyTakesAreDroppedOldestKept) {
  ASSERT_TRUE(bench.run_until_ready(3000));
  for (int i = 0; i < 40; ++i) {  // as run(), but takes nothing
    bench.now += milliseconds(10);
    bench.link.set_now(bench.now);
    bench.send(raw_packet(0));
    bench.driver->step(bench.now);
  }
  EXPECT_GT(bench.counter("readings_dropped"), 2000u);
}

TEST_F(LwnxRaw, StepsAskTheHeapForNothing) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "the heap cannot be watched here";
  }
  ASSERT_TRUE(bench.run_until_ready(3000));
  for (int i = 0; i < 100; ++i) {
    bench.now += milliseconds(10);
    bench.link.set_now(bench.now);
    bench.send(i % 7 == 3 ? std::string("noise\xAA\x40") : raw_packet(i));
    std::array<RangeSample, 512> into{};
    const tests::NoAllocScope scope;
    bench.driver->step(bench.now);
    (void)bench.driver->take(into);
    EXPECT_EQ(scope.heap_calls(), 0u);
  }
}

}  // namespace
}  // namespace slamsensor::hal
