#include "tests/unit/tools/emulator/rangefinder/lwnx_bench.hpp"

namespace slamsensor::tools {
namespace {

LwnxSettings fast_lw20(std::uint32_t baud) {
  LwnxSettings settings = ready(LwnxModel::Lw20);
  settings.baud = baud;
  set_rate(settings, 20'000.0);
  return settings;
}

TEST(LwnxStream, RawReadingsComeAtTwentyKilohertz) {
  LwnxBench bench(fast_lw20(921'600));
  bench.say(write_request(30, 1, 4), Stamp{});
  const Stamp start = bench.now;
  const auto packets = payloads(bench.run(1s));
  ASSERT_EQ(packets.size(), 100U);
  EXPECT_EQ(packets[0].size(), 402U);
  EXPECT_EQ(packets[0][1], 200);
  EXPECT_EQ(bench.device.records_dropped(), 0U);
  ASSERT_EQ(bench.scene.shots.size(), 20'000U);
  EXPECT_EQ(bench.scene.shots.front(), start + 50us);
  EXPECT_EQ(bench.scene.shots.back(), start + 1s);
  ASSERT_EQ(bench.scene.reports.size(), 20'000U);
  EXPECT_EQ(bench.scene.reports[0].on_wire, start + 10ms);  // the whole packet of 200 goes at once
  EXPECT_EQ(bench.scene.reports[199].on_wire, start + 10ms);
  EXPECT_EQ(bench.scene.reports[200].measured, start + 10ms + 50us);
}

TEST(LwnxStream, SlowLineDropsWholePackets) {
  LwnxBench bench(fast_lw20(115'200));
  bench.say(write_request(30, 1, 4), Stamp{});
  const auto packets = payloads(bench.run(2s));
  // 407 bytes take 35.3 ms of every 10: one packet of three or four gets through, unbroken.
  EXPECT_GT(packets.size(), 52U);
  EXPECT_LT(packets.size(), 60U);
  EXPECT_EQ(packets.size() + bench.device.records_dropped(), 200U);
  EXPECT_EQ(bench.scene.reports.size(), 200 * packets.size());
  for (std::size_t i = 1; i < bench.scene.reports.size(); ++i) {
    const auto& report = bench.scene.reports[i];
    ASSERT_LT(report.on_wire - report.measured, 60ms);
    ASSERT_GE(report.on_wire, bench.scene.reports[i - 1].on_wire);
  }
}

TEST(LwnxStream, EveryRateOfEveryProductIsKept) {
  for (const LwnxModel model :
       {LwnxModel::Lw20, LwnxModel::Lw24, LwnxModel::Sf000, LwnxModel::Sf30d, LwnxModel::Sf45b}) {
    const LightWareProduct product = lwnx_product(model);
    for (const std::uint32_t baud : {115'200U, 921'600U}) {
      for (std::size_t i = 0; i < product.rates_hz.size(); ++i) {
        LwnxSettings settings = ready(model);
        settings.baud = baud;
        settings.product.find(product.ids.update_rate)->initial =
            static_cast<std::int64_t>(product.first_rate_value + i);
        LwnxBench bench(settings);
        bench.say(write_request(30, 5, 4), Stamp{});
        const Stamp start = bench.now;
        bench.run(1s);
        const double period_ns = 1e9 / product.rates_hz[i];
        ASSERT_EQ(bench.scene.shots.size(), static_cast<std::size_t>(product.rates_hz[i] + 1e-6))
            << product.name << i;
        const double last = static_cast<double>(bench.scene.shots.size()) * period_ns;
        EXPECT_NEAR(static_cast<double>((bench.scene.shots.back() - start).count()), last, 1.0);
        const double line_share = product.rates_hz[i] * 100.0 / baud;  // ten bytes of ten bits
        EXPECT_EQ(bench.device.records_dropped() > 0, line_share > 1.0) << product.name << i << " " << baud;
      }
    }
  }
}

TEST(LwnxStream, CrystalRunsFast) {
  LwnxSettings settings = fast_lw20(921'600);
  settings.crystal_ppm = 50.0;
  LwnxBench bench(settings);
  bench.say(write_request(30, 1, 4), Stamp{});
  bench.run(10s);
  EXPECT_EQ(bench.scene.shots.size(), 200'010U);
}

TEST(LwnxStream, DelayAndJitterKeepTheOrder) {
  LwnxSettings settings = sf000_at_1_khz();
  settings.delays.record = {5ms, 2ms};
  LwnxBench bench(settings);
  bench.say(write_request(30, 5, 4), Stamp{});
  bench.run(5s);
  ASSERT_GT(bench.scene.reports.size(), 4900U);
  double sum_s = 0.0;
  for (std::size_t i = 1; i < bench.scene.reports.size(); ++i) {
    const auto& report = bench.scene.reports[i];
    ASSERT_GT(report.measured, bench.scene.reports[i - 1].measured);
    ASSERT_GE(report.on_wire, bench.scene.reports[i - 1].on_wire);
    sum_s += hal::to_seconds(report.on_wire - report.measured);
  }
  EXPECT_NEAR(sum_s / static_cast<double>(bench.scene.reports.size()), 0.0075, 0.0015);  // queueing included
}

TEST(LwnxStream, EqualSeedsGiveEqualBytes) {
  std::vector<Bytes> runs;
  for (const std::uint64_t seed : {7U, 7U, 8U}) {
    LwnxSettings settings = sf000_at_1_khz();
    settings.delays.record = {5ms, 2ms};
    settings.seed = seed;
    LwnxBench bench(settings);
    bench.say(write_request(30, 5, 4), Stamp{});
    bench.run(1s);
    Bytes times;
    for (const auto& report : bench.scene.reports) {
      append_little_endian(report.on_wire.count(), 8, times);
    }
    runs.push_back(times);
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_NE(runs[0], runs[2]);
}

TEST(LwnxStream, MillimetresComeInFourBytes) {
  LwnxBench bench(ready(LwnxModel::Sf45b));
  bench.say(write_request(27, 0x01, 4));
  bench.say(write_request(30, 6, 4), Stamp{});
  const auto packets = payloads(bench.run(20ms));
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(hex(packets[0]), "2D 34 30 00 00");  // 12340 mm
}

TEST(LwnxStream, Grf500SendsDecimetres) {
  LwnxBench bench(ready(LwnxModel::Grf500));
  bench.say(write_request(27, 0x01, 4));
  bench.say(write_request(30, 5, 4), Stamp{});
  const auto packets = payloads(bench.run(200ms));
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(hex(packets[0]), "2C 7B 00 00 00");  // 12.3 m
}

TEST(LwnxStream, Sf30dHasItsOwnIdsAndFullSpeed) {
  LwnxBench bench(ready(LwnxModel::Sf30d));
  EXPECT_EQ(bench.device.baud(), 921'600U);
  EXPECT_FALSE(bench.say(write_request(76, 8, 1)).empty());
  EXPECT_FALSE(bench.say(write_request(29, 0xFFFFFFFF, 4)).empty());
  EXPECT_TRUE(bench.say(write_request(27, 1, 4)).empty());
  bench.say(write_request(30, 5, 4), Stamp{});
  auto packets = payloads(bench.run(1s));
  EXPECT_EQ(packets.size(), 78U);
  EXPECT_EQ(packets[0].size(), 13U);  // all six fields
  bench.say(write_request(30, 11, 4), Stamp{});
  packets = payloads(bench.run(100ms));
  EXPECT_EQ(packets.size(), 10U);
  EXPECT_EQ(packets[0][0], 40);
}

}  // namespace
}  // namespace slamsensor::tools
