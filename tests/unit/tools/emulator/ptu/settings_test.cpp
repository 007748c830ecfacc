#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

TEST(PtuSettingsTest, TheWordsOfAResetChooseOrAlsoReset) {
  PtuSettings settings = exact_settings();
  settings.reset_time = 1s;
  PtuBench chooses(settings);
  EXPECT_EQ(chooses.ask("RP ", 1s), "RP *\r\n");
  settings.reset_words = PtuResetWords::ChooseAndReset;
  PtuBench resets(settings);
  EXPECT_EQ(resets.ask("RP ", 1s), "RP !P!P*\r\n");
}

TEST(PtuSettingsTest, LatencyIsThatOfTheSettingsAndItsJitterRepeats) {
  const auto gaps = [](std::uint64_t seed) {
    PtuSettings settings = exact_settings();
    settings.reply_latency = {3ms, 1ms};
    PtuBench bench(settings, seed);
    bench.ask("ED FT ");
    std::vector<double> found;
    for (int i = 0; i < 200; ++i) {
      const Stamp typed = bench.now + hal::line_time(3, 9600);
      bench.type("PP ");
      bench.run_for(50ms);
      found.push_back(hal::to_seconds(bench.bytes.front().at - hal::line_time(1, 9600) - typed));
      bench.bytes.clear();
    }
    return found;
  };
  const std::vector<double> first = gaps(4);
  double sum = 0.0;
  double sum2 = 0.0;
  for (const double gap : first) {
    sum += gap;
    sum2 += (gap - 0.003) * (gap - 0.003);
  }
  EXPECT_NEAR(sum / 200.0, 0.003, 0.0003);
  EXPECT_NEAR(std::sqrt(sum2 / 200.0), 0.001, 0.0002);
  EXPECT_EQ(first, gaps(4));
  EXPECT_NE(first, gaps(5));
}

}  // namespace
}  // namespace slamsensor::tools
