#include "hal/rangefinder/point_record.hpp"

#include "tests/unit/hal/rangefinder/hex.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace slamsensor::hal {
namespace {

using tests::hex_text;

std::vector<Measurement> parse(const PointLaserConfig& config, const std::string& text,
                               RangeCounters* counters = nullptr) {
  RangeCounters own;
  const auto records = make_point_records(config, counters != nullptr ? *counters : own);
  std::vector<Measurement> out;
  for (const char c : text) {
    if (records->push(static_cast<std::uint8_t>(c))) {
      out.push_back(records->reading());
      EXPECT_LT(records->begin(), records->end());
      EXPECT_LE(records->end(), text.size());
    }
  }
  return out;
}

std::string times(const std::string& text, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) {
    out += text;
  }
  return out;
}

TEST(AsciiNumber, DecimalGrammarIsWhole) {
  AsciiNumber out;
  EXPECT_TRUE(read_decimal("004.996", '\0', out));
  EXPECT_EQ(out.number, 4996);
  EXPECT_EQ(out.decimals, 3u);
  EXPECT_TRUE(read_decimal("-1.00", '\0', out));
  EXPECT_EQ(out.number, -100);
  EXPECT_TRUE(read_decimal("  +12", '\0', out));
  EXPECT_EQ(out.number, 12);
  EXPECT_TRUE(read_decimal("004.996_000985", '_', out));
  EXPECT_TRUE(out.has_strength);
  EXPECT_EQ(out.strength, 985);
  for (const char* bad : {"",
                          " ",
                          "-",
                          ".",
                          "1.",
                          ".5",
                          "1..2",
                          "1.2.3",
                          "1 2",
                          "1-",
                          "1e5",
                          "nan",
                          "inf",
                          "0x1",
                          "12.3m",
                          "1234567890123",
                          "123456.1234567",
                          "+-1",
                          "1,5",
                          "99999999999999999999"}) {
    EXPECT_FALSE(read_decimal(bad, '\0', out)) << bad;
  }
  for (const char* bad : {"1_", "1_x", "1_2_3", "_2", "1_-2", "1_99999999999999"}) {
    EXPECT_FALSE(read_decimal(bad, '_', out)) << bad;
  }
}

TEST(AsciiNumber, HexGrammarIsWhole) {
  AsciiNumber out;
  EXPECT_TRUE(read_hex("001384", out));
  EXPECT_EQ(out.number, 4996);
  EXPECT_TRUE(read_hex("fFfFffFF", out));
  EXPECT_EQ(out.number, 0xFFFFFFFF);
  for (const char* bad : {"", "123456789", "12G4", " 12", "-1"}) {
    EXPECT_FALSE(read_hex(bad, out)) << bad;
  }
}

TEST(AsciiRecords, FirstTwoOnlySecureTheStream) {
  // The first line may have lost its front, the second confirms the layout, from the third on they count.
  const auto out = parse(PointLaserConfig{}, times("12.345\r\n", 5));
  ASSERT_EQ(out.size(), 3u);
  EXPECT_DOUBLE_EQ(out[0].range_m, 12.345);
  EXPECT_EQ(out[0].echo, Echo::Return);
}

TEST(AsciiRecords, LayoutsOfTheManuals) {
  PointLaserConfig config;
  config.width = 7;
  EXPECT_NEAR(parse(config, times("004.996\r\n", 3)).at(0).range_m, 4.996, 1e-12);
  config.width = 14;
  config.strength_separator = '_';
  const auto with_signal = parse(config, times("004.996_000985\r\n", 3));
  EXPECT_NEAR(with_signal.at(0).range_m, 4.996, 1e-12);
  EXPECT_DOUBLE_EQ(with_signal.at(0).strength, 985.0);
  config = {};
  config.record = PointRecord::AsciiHex;
  config.prefix = " ";
  config.width = 7;
  config.unit_m = 0.001;
  EXPECT_NEAR(parse(config, times(" 001384\r\n", 3)).at(0).range_m, 4.996, 1e-12);
}

TEST(AsciiRecords, TextsAndCodesAreNoDistance) {
  PointLaserConfig config = astech_lds70a();
  for (const auto& [text, echo] :
       {std::pair{"DE02", Echo::None}, {"DE04", Echo::Fault}, {"DE06", Echo::Fault}, {"DE10", Echo::Fault}}) {
    const auto out = parse(config, times(std::string(text) + "\r\n", 4));
    ASSERT_EQ(out.size(), 2u) << text;
    EXPECT_EQ(out[0].echo, echo);
    EXPECT_EQ(out[0].range_m, 0.0);
  }
  EXPECT_TRUE(parse(config, times("DE03\r\n", 5)).empty());
  config = {};
  config.texts = {{"E15", Echo::Weak}};
  config.codes = {{-100, Echo::None}, {99999, Echo::Saturated}};
  EXPECT_EQ(parse(config, times("E15\r\n", 3)).at(0).echo, Echo::Weak);
  EXPECT_EQ(parse(config, times("-1.00\r\n", 3)).at(0).echo, Echo::None);
  EXPECT_EQ(parse(config, times("999.99\r\n", 3)).at(0).echo, Echo::Saturated);
  EXPECT_EQ(parse(config, times("-5.0\r\n", 3)).at(0).echo, Echo::None);
  EXPECT_EQ(parse(config, times("0.000\r\n", 3)).at(0).echo, Echo::None);
  EXPECT_EQ(parse(config, times("300.001\r\n", 3)).at(0).echo, Echo::None);
}

TEST(AsciiRecords, Lds70aWithAndWithoutTheLetter) {
  for (const char* record : {"D0012.345\r\n", "00012.345\r\n", "   12.345\r\n"}) {
    EXPECT_NEAR(parse(astech_lds70a(), times(record, 3)).at(0).range_m, 12.345, 1e-12) << record;
  }
  for (const char* record : {"D0012.34\r\n", "D00012.345\r\n", "X0012.345\r\n", "DD012.345\r\n"}) {
    EXPECT_TRUE(parse(astech_lds70a(), times(record, 5)).empty()) << record;
  }
}

TEST(AsciiRecords, FixedWidthTurnsEveryLossIntoNothing) {
  for (const char* record : {"00012.345\r\n", "00298.765\r\n"}) {
    const std::string one(record);
    const double truth = std::stod(one);
    const std::string good = times(one, 4);
    for (std::size_t at = 0; at < 2 * one.size(); ++at) {
      for (std::size_t lost = 1; lost <= one.size() - 1; ++lost) {
        std::string stream = good + good + good;
        stream.erase(good.size() + at, lost);
        for (const Measurement& out : parse(astech_lds70a(), stream)) {
          // Losing whole records' length in the middle can leave a record of the right width, of equal text.
          EXPECT_NEAR(out.range_m, truth < 290.0 ? truth : 0.0, 1e-9) << at << " lost " << lost;
        }
      }
    }
  }
}

TEST(AsciiRecords, LostTerminatorGluesNoRecords) {
  PointLaserConfig config;
  for (const char* glued : {"12.34512.345\r\n", "12.345\r12.345\r\n", "12.345\n12.345\r\n"}) {
    RangeCounters counters;
    const auto out = parse(config, times("12.345\r\n", 4) + glued + times("12.345\r\n", 4), &counters);
    EXPECT_EQ(out.size(), 2u + 3u) << glued;  // one withheld after the loss
    for (const Measurement& one : out) {
      EXPECT_NEAR(one.range_m, 12.345, 1e-12);
    }
    EXPECT_EQ(counters[RangeEvent::RecordsRefused], 1u);
    EXPECT_EQ(counters[RangeEvent::LocksLost], 1u);
  }
}

TEST(AsciiRecords, DecimalsGiveAwayWhatAVariableWidthCannot) {
  PointLaserConfig config;
  config.decimals = 3;
  EXPECT_EQ(parse(config, times("12.345\r\n", 4)).size(), 2u);
  EXPECT_TRUE(parse(config, times("12.34\r\n", 4)).empty());
  EXPECT_TRUE(parse(config, times("12345\r\n", 4)).empty());
}

TEST(AsciiRecords, EndlessLineIsBounded) {
  RangeCounters counters;
  EXPECT_EQ(parse({}, std::string(10000, '7') + "\r\n" + times("1.5\r\n", 4), &counters).size(), 3u);
  EXPECT_GT(counters[RangeEvent::LengthsRefused], 100u);
}

PointLaserConfig packed(std::size_t bytes) {
  PointLaserConfig config;
  config.record = PointRecord::Packed7;
  config.packed_bytes = bytes;
  config.unit_m = 0.01;
  config.codes = {{16000, Echo::None}, {0, Echo::Fault}};
  return config;
}

TEST(Packed7Records, ExamplesOfTheSf30) {
  const auto out = parse(packed(2), hex_text("89 52 89 52 89 52 FD 00 FD 00 80 00 80"));
  ASSERT_EQ(out.size(), 5u);
  EXPECT_NEAR(out[0].range_m, 12.34, 1e-12);
  EXPECT_EQ(out[2].echo, Echo::None);
  EXPECT_EQ(out[4].echo, Echo::Fault);
}

TEST(Packed7Records, ThreeBytes) {
  const auto out = parse(packed(3), times(hex_text("81 09 52"), 3) + "\x81");
  ASSERT_EQ(out.size(), 2u);
  EXPECT_NEAR(out[0].range_m, (1 * 16384 + 9 * 128 + 82) * 0.01, 1e-9);
}

TEST(Packed7Records, RecordOfTheWrongLengthIsRefused) {
  // A byte lost, one too many: the record goes, and the next one only secures the stream.
  const std::string good = times(hex_text("89 52"), 4);
  for (const char* bad : {"89", "89 52 52", "89 52 52 52 52 52"}) {
    RangeCounters counters;
    const auto out = parse(packed(2), good + hex_text(bad) + good + "\x89", &counters);
    EXPECT_EQ(out.size(), 3u + 3u) << bad;
    EXPECT_EQ(counters[RangeEvent::LocksLost], 1u);
    for (const Measurement& one : out) {
      EXPECT_NEAR(one.range_m, 12.34, 1e-12);
    }
  }
}

TEST(PointRecords, NoiseNeverLeavesTheRules) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    std::mt19937 engine(seed);
    std::string noise;
    for (int i = 0; i < 5000; ++i) {
      noise += "0123456789.\r\n D"[engine() % 15];
    }
    for (const Measurement& out : parse(astech_lds70a(), noise)) {
      EXPECT_TRUE(std::isfinite(out.range_m));
      EXPECT_EQ(out.range_m > 0.0, out.echo == Echo::Return);
      EXPECT_LE(out.range_m, 290.0);
    }
  }
}

// A number whose whole part and fraction were short enough each, but not together (found by fuzzing).
TEST(PointRecord, ManyDigitsAreNoNumber) {
  AsciiNumber number;
  EXPECT_FALSE(read_decimal("412494122.0088888888888", '\0', number));
  EXPECT_FALSE(read_decimal("412494122008.8888888888888", '\0', number));
  EXPECT_TRUE(read_decimal("412494122.008", '\0', number));
  EXPECT_EQ(number.number, 412494122008);
}

}  // namespace
}  // namespace slamsensor::hal
