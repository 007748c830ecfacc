#include "core/fix.hpp"
#include "tools/output/text_output.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace slamsensor::tools {
namespace {

std::string shortest(double value) {
  std::string out;
  append_shortest(out, value);
  return out;
}

TEST(NumberText, FixedHasItsDecimalsAndNoNegativeZero) {
  EXPECT_EQ(fixed_text(1.5, 3), "1.500");
  EXPECT_EQ(fixed_text(-0.0004, 3), "0.000");
  EXPECT_EQ(fixed_text(-0.0006, 3), "-0.001");
  EXPECT_EQ(fixed_text(-0.0, 0), "0");
  EXPECT_EQ(fixed_text(std::numeric_limits<double>::max(), 9).size(), 319U);
}

TEST(NumberText, ShortestReadsBackTheSame) {
  EXPECT_EQ(shortest(7.0), "7");
  EXPECT_EQ(shortest(1700000000.25), "1700000000.25");
  EXPECT_EQ(shortest(0.1), "0.1");
  for (const double value : {1.0 / 3.0, -1e300, std::numeric_limits<double>::denorm_min()}) {
    const std::string text = shortest(value);
    double read = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), read);
    EXPECT_EQ(read, value) << text;
  }
}

TEST(NumberText, GeneralUsesAnExponentWhereShorter) {
  std::string out;
  append_general(out, 1.25e-30, 6);
  out += ' ';
  append_general(out, 0.5, 6);
  EXPECT_EQ(out, "1.25e-30 0.5");
}

TEST(NumberText, IntegersAtTheirLimits) {
  std::string out;
  append_integer(out, std::numeric_limits<std::int64_t>::min());
  append_integer(out, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(out, "-922337203685477580818446744073709551615");
}

static_assert(core::to_string(core::FixStatus::NoFix) == "no_fix");
static_assert(core::to_string(core::FixStatus::Ambiguous) == "ambiguous");
static_assert(core::to_string(core::FixReason::TooFewLandmarks) == "too_few_landmarks");
static_assert(core::to_string(core::FixReason::NoOverlap) == "no_overlap");
static_assert(core::to_string(core::FixReason::Copy) == "copy");
static_assert(core::to_string(core::FixReason::LocalMap) == "local_map");
static_assert(core::to_string(core::FixReason::NoScan) == "no_scan");
static_assert(core::to_string(core::SearchEnd::NotStarted) == "not_started");
static_assert(core::to_string(static_cast<core::FixReason>(200)) == "unknown");

}  // namespace
}  // namespace slamsensor::tools
