#include "tests/unit/tools/emulator/ptu/ptu_bench.hpp"

#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

std::string raw(std::initializer_list<int> codes) {
  std::string text;
  for (const int code : codes) {
    text += static_cast<char>(code);
  }
  return text;
}

std::string ask(PtuBench& bench, std::initializer_list<int> codes, Stamp span = 200ms) {
  return ptu_text(bench.ask(raw(codes), span));
}

TEST(PtuBinary, AnswersTheKnownExamples) {
  PtuBench bench;
  EXPECT_EQ(ask(bench, {0x81, 0xF6, 0x3C}, 3s), ptu_text(raw({0x00})));
  EXPECT_EQ(ask(bench, {0x91}), ptu_text(raw({0xF6, 0x3C})));
  EXPECT_EQ(ask(bench, {0xA5}), ptu_text(raw({0x00, 0x00, 0x2B, 0x65})));
  EXPECT_EQ(ask(bench, {0x91, 0x92}), ptu_text(raw({0xF6, 0x3C, 0x00, 0x00})));
}

TEST(PtuBinary, MixesWithText) {
  PtuBench bench;
  EXPECT_EQ(ptu_text(bench.ask("ED FT " + raw({0x91}) + "PP " + raw({0xB4}))),
            "ED *\\r\\n*\\r\\n" + ptu_text(raw({0, 0})) + "* 0\\r\\n" + ptu_text(raw({0})));
}

TEST(PtuBinary, RefusesWithAStatus) {
  PtuBench bench;
  EXPECT_EQ(ask(bench, {129, 0x7F, 0xFF}), ptu_text(raw({3})));
  EXPECT_EQ(ask(bench, {135, 0x7F, 0xFF}), ptu_text(raw({4})));
  EXPECT_EQ(ask(bench, {137, 0, 1}), ptu_text(raw({4})));
  EXPECT_EQ(ask(bench, {250}), ptu_text(raw({2})));
  EXPECT_EQ(ask(bench, {177}), ptu_text(raw({17})));
  EXPECT_EQ(ask(bench, {143, 1, 0}), ptu_text(raw({10})));
  EXPECT_EQ(ask(bench, {197, 9}), ptu_text(raw({11})));
  EXPECT_EQ(ask(bench, {222}), ptu_text(raw({2})));  // not on a D46
}

TEST(PtuBinary, QueriesEveryQuantity) {
  PtuBench bench;
  EXPECT_EQ(ask(bench, {149, 152}), ptu_text(raw({0xF3, 0xEE, 0x02, 0x5C})));  // -3090, 604
  EXPECT_EQ(ask(bench, {155, 157, 159, 161}), ptu_text(raw({3, 0xE8, 3, 0xE8, 0x0B, 0x56, 0, 31})));
  EXPECT_EQ(ask(bench, {163}), ptu_text(raw({0, 0, 0x07, 0xD0})));
  EXPECT_EQ(ask(bench, {171, 173, 171, 172}), ptu_text(raw({1, 0, 0, 0})));
  EXPECT_EQ(ask(bench, {180, 182, 180, 190, 192, 190}), ptu_text(raw({1, 0, 0, 1, 0, 0})));
  EXPECT_EQ(ask(bench, {186, 197, 4, 186, 188}), ptu_text(raw({3, 0, 4, 2})));
  EXPECT_EQ(ask(bench, {203, 205, 203, 135, 0xFE, 0x0C}), ptu_text(raw({1, 0, 2, 0})));  // velocity -500
  EXPECT_EQ(ask(bench, {153}, 300ms), ptu_text(raw({0xFE, 0x0C})));
  EXPECT_EQ(ask(bench, {168, 204}, 300ms), ptu_text(raw({0, 0})));
  EXPECT_EQ(bench.ask(raw({196}), 500ms).back(), '\n');
}

TEST(PtuBinary, MovesSlavedAndAwaits) {
  PtuBench bench;
  EXPECT_EQ(ask(bench, {175, 129, 0x01, 0xF4, 132, 0x00, 0x64, 145}), ptu_text(raw({0, 0, 0, 0, 0})));
  EXPECT_EQ(ask(bench, {167}, 400ms), "");
  bench.run_for(300ms);
  EXPECT_EQ(ptu_text(bench.heard()), ptu_text(raw({0})));
  EXPECT_EQ(ask(bench, {145, 148, 174}), ptu_text(raw({0x01, 0xF4, 0, 100, 0})));
}

TEST(PtuBinary, TellsLimitsHitAsBytesOfTheirOwn) {
  PtuSettings settings = exact_settings();
  settings.reset_time = 1s;
  PtuBench bench(settings);
  EXPECT_EQ(ask(bench, {176}, 2s), ptu_text(raw({221, 221, 220, 220, 0})));
  ask(bench, {173, 129, 0x0F, 0xA0}, 4s);  // 4000, beyond the stop
  EXPECT_NEAR(bench.pan_steps(bench.now), 3290.0, 0.51);
}

TEST(PtuBinary, SetsAndGetsMotionAtOnceInTheESeries) {
  PtuBench bench(exact_settings(PtuKind::E46_17_5));
  EXPECT_EQ(ask(bench, {222, 0x00, 0x64, 0xFF, 0x9C, 0x03, 0xE8, 0x01, 0xF4}, 2s), ptu_text(raw({0})));
  EXPECT_EQ(ask(bench, {223}), ptu_text(raw({0, 0x64, 0xFF, 0x9C, 0, 0, 0, 0})));
  EXPECT_EQ(ask(bench, {205}), ptu_text(raw({0})));
  EXPECT_EQ(ask(bench, {234, 0x01, 0xF4, 0xFE, 0x0C, 0x00}), ptu_text(raw({20})));
  EXPECT_EQ(ask(bench, {234, 0x01, 0xF4, 0xFE, 0x0C, 0xFF}), ptu_text(raw({0})));
  EXPECT_EQ(ask(bench, {153, 154}), ptu_text(raw({0x01, 0xF4, 0xFE, 0x0C})));
}

}  // namespace
}  // namespace slamsensor::tools
