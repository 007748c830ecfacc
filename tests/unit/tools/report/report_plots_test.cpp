#include "tools/report/report_plots.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::string_view kHead =
    "scan,status,sigma_x_m,sigma_y_m,error_xi,matches,landmarks_seen,protection_radius_m,t_s,milliseconds\n";

std::vector<ReportRow> rows_of(const std::string& rows) {
  auto parsed = parse_report_rows(std::string(kHead) + rows, "fixes.csv");
  EXPECT_TRUE(parsed) << (parsed ? "" : parsed.error().message);
  return parsed.value_or(std::vector<ReportRow>());
}

TEST(ReportPlots, EmptyFieldsAreAbsentAndOthersNumbers) {
  const auto rows = rows_of("0,fix,0.3,0.4,2,20,25,1.5,0.5,3.25\n1,no_fix,,,,4,25,,1.5,\n");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_TRUE(rows[0].is_fix);
  EXPECT_DOUBLE_EQ(rows[0].sigma_m.value(), 0.5);
  EXPECT_EQ(rows[0].xi, 2.0);
  EXPECT_EQ(rows[0].milliseconds, 3.25);
  EXPECT_FALSE(rows[1].is_fix);
  EXPECT_FALSE(rows[1].sigma_m || rows[1].xi || rows[1].protection_radius_m || rows[1].milliseconds);
  EXPECT_EQ(rows[1].matches, 4.0);
}

TEST(ReportPlots, AFieldThatIsNoNumberIsRefusedWithItsLine) {
  const auto parsed = parse_report_rows(std::string(kHead) + "0,fix,0.3,x,2,20,25,1.5,0.5,\n", "fixes.csv");
  ASSERT_FALSE(parsed);
  EXPECT_NE(parsed.error().message.find("fixes.csv:2: "), std::string::npos) << parsed.error().message;
  EXPECT_FALSE(parse_report_rows(kHead, "fixes.csv"));
  EXPECT_FALSE(parse_report_rows("a,b\n1,2\n", "fixes.csv"));
}

TEST(ReportPlots, ErrorsAreThoseOfTheScanWithTheirTime) {
  const auto rows = rows_of(
      "0,fix,0.03,0.04,0,20,25,0.2,10,1\n1,no_fix,,,,4,25,,20,1\n2,fix,0.03,0.04,1,20,25,0.2,30,1\n"
      "3,fix,0.03,0.04,1,20,25,0.2,40,1\n");
  AlignedErrors errors;
  errors.fixes = {{10.0, 0, 0.0, 0.0, false}, {30.0, 2, 0.3, 0.0, false}, {40.0, 3, 0.1, 0.0, false}};
  const auto plots = report_plots(rows, errors);
  ASSERT_EQ(plots.size(), 5U);
  EXPECT_EQ(plots[2].name, "error");
  EXPECT_EQ(plots[2].plot.series[0].points, (std::vector<core::Point2>{{0.0, 0.0}, {2.0, 0.3}, {3.0, 0.1}}));
  EXPECT_EQ(plots[2].plot.summary[0], "1 of 3 errors exceed the protection radius");
  EXPECT_EQ(plots[3].plot.summary[0], "1 of 3 errors exceed three sigma");
  const auto& rms = plots[4].plot.series[1].points;
  ASSERT_EQ(rms.size(), 2U);
  EXPECT_NEAR(rms[1].y(), std::sqrt((0.09 + 0.01) / 2.0), 1e-12);
}

TEST(ReportPlots, WithoutTruthAndTimesThereIsThePlotOfMatches) {
  const auto plots = report_plots(rows_of("0,fix,0.3,0.4,2,20,25,1.5,0.5,\n1,no_fix,,,,4,25,,1.5,\n"), {});
  ASSERT_EQ(plots.size(), 1U);
  EXPECT_EQ(plots[0].plot.summary[0], "1 of 2 scans gave a fix");
  EXPECT_EQ(plots[0].plot.series.size(), 3U);
  EXPECT_EQ(plots[0].plot.x_step_min, 1.0);
  EXPECT_EQ(plots[0].plot.y_step_min, 1.0);
}

}  // namespace
}  // namespace slamsensor::tools
