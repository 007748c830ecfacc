#include "tools/plot/scales.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace slamsensor::tools {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

TEST(AxisTicks, RoundStepsAreOneTwoFive) {
  EXPECT_DOUBLE_EQ(round_step_up(0.03), 0.05);
  EXPECT_DOUBLE_EQ(round_step_up(1.0), 1.0);
  EXPECT_DOUBLE_EQ(round_step_up(5.1), 10.0);
  EXPECT_DOUBLE_EQ(round_step_down(0.03), 0.02);
  EXPECT_DOUBLE_EQ(round_step_down(1000.0), 1000.0);
  EXPECT_DOUBLE_EQ(round_step_down(9.9), 5.0);
}

TEST(AxisTicks, LinearTicksIncludeLimitsThatAreMultiples) {
  EXPECT_THAT(linear_ticks(-0.2, 0.3, 0.1), ElementsAre(DoubleEq(-0.2), DoubleEq(-0.1), DoubleEq(0.0),
                                                        DoubleEq(0.1), DoubleEq(0.2), DoubleEq(3 * 0.1)));
  EXPECT_THAT(linear_ticks(1.0, 9.0, 10.0), ElementsAre());
}

TEST(AxisTicks, TextHasTheDecimalsOfTheStep) {
  EXPECT_EQ(tick_text(-20.0, 10.0), "-20");
  EXPECT_EQ(tick_text(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(tick_text(-1e-17, 0.05), "0.00");
  EXPECT_EQ(tick_text(3e7, 1e7), "3e+07");
}

TEST(AxisTicks, LogTicksArePowersOfTen) {
  std::vector<double> values;
  for (const LogTick& tick : log_ticks(5.0, 2e5)) values.push_back(tick.value);
  EXPECT_THAT(values, ElementsAre(DoubleEq(10), DoubleEq(100), DoubleEq(1e3), DoubleEq(1e4), DoubleEq(1e5)));
}

TEST(AxisTicks, ShortLogRangesAlsoHaveTwoAndFive) {
  std::vector<double> values;
  for (const LogTick& tick : log_ticks(1.0, 10.0)) values.push_back(tick.value);
  EXPECT_THAT(values, ElementsAre(DoubleEq(1), DoubleEq(2), DoubleEq(5), DoubleEq(10)));
}

TEST(AxisTicks, LongLogRangesAreThinned) {
  EXPECT_LE(log_ticks(1e-100, 1e100).size(), 11U);
}

TEST(Palette, ClassesCoverEveryXiOnce) {
  for (const std::uint32_t max_xi :
       {0U, 1U, 9U, 10U, 38U, 99U, 100U, 12345U, std::numeric_limits<std::uint32_t>::max()}) {
    const std::vector<XiClass> classes = xi_classes(max_xi);
    ASSERT_LE(classes.size(), 10U) << max_xi;
    EXPECT_EQ(classes.front().first, 0U);
    EXPECT_GE(classes.back().last, max_xi);
    EXPECT_LE(classes.back().first, max_xi);
    for (std::size_t i = 1; i < classes.size(); ++i) {
      EXPECT_EQ(classes[i].first, classes[i - 1].last + 1) << max_xi;
      EXPECT_NE(classes[i].colour, classes[i - 1].colour) << max_xi;
    }
  }
}

TEST(Palette, ClassesAreLabelledByTheirRange) {
  EXPECT_EQ(class_text(xi_classes(4)[3]), "3");
  EXPECT_EQ(class_text(xi_classes(38)[1]),
            "5\xE2\x80\x93"
            "9");
}

}  // namespace
}  // namespace slamsensor::tools
