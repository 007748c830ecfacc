#include "tools/plot/curve_plot.hpp"

#include "tests/unit/tools/plot/xml_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace slamsensor::tools {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

CurvePlot chart(std::vector<core::Point2> points, AxisScale scale = AxisScale::Linear) {
  CurvePlot plot;
  plot.title = "Edges against depth";
  plot.x_label = "depth";
  plot.y_label = "edges";
  plot.y_scale = scale;
  plot.series.push_back({"measured", std::move(points), CurveStyle::LineAndMarkers});
  return plot;
}

TEST(CurvePlot, IsWellFormedAndDeterministic) {
  const CurvePlot plot = chart({{1, 2980}, {2, 9784}, {3, 20000}}, AxisScale::Logarithmic);
  EXPECT_EQ(xml_fault(draw_curve(plot)), "");
  EXPECT_EQ(draw_curve(plot), draw_curve(plot));
  EXPECT_THAT(draw_curve(plot), HasSubstr(">10000<"));
}

TEST(CurvePlot, AllPointsAreInsideTheFrame) {
  for (const AxisScale scale : {AxisScale::Linear, AxisScale::Logarithmic}) {
    for (const auto& points : {std::vector<core::Point2>{{1, 5}},
                               {{0, 1e-9}, {1, 1e9}},
                               {{-3, 7}, {9, 7.001}},
                               {{1e6, 1e-300}, {1e6, 2e-300}}}) {
      const CurveFrame frame = frame_curve(chart(points, scale), {10.0, 20.0});
      for (const core::Point2& point : points) {
        EXPECT_TRUE(frame.area.contains(box_around(frame.to_px(point), 0.0))) << point.transpose();
      }
      EXPECT_EQ(xml_fault(draw_curve(chart(points, scale))), "");
    }
  }
}

TEST(CurvePlot, LinearAxisBeginsAtZeroUnlessValuesAreFarFromIt) {
  EXPECT_EQ(frame_curve(chart({{0, 1}, {1, 3}}), {0, 0}).low.y(), 0.0);
  EXPECT_GT(frame_curve(chart({{0, 100}, {1, 101}}), {0, 0}).low.y(), 90.0);
  EXPECT_LE(frame_curve(chart({{0, -4}, {1, 3}}), {0, 0}).low.y(), -4.0);
}

TEST(CurvePlot, TheHighestValueIsBelowTheUpperEdge) {
  EXPECT_GT(frame_curve(chart({{0, 0}, {1, 60}}), {0, 0}).high.y(), 60.0);
  EXPECT_GT(frame_curve(chart({{0, 0}, {1, 59.9}}), {0, 0}).high.y(), 60.0);
}

TEST(CurvePlot, AFullTurnHasATickEach50Degrees) {
  EXPECT_EQ(frame_curve(chart({{-180, 1}, {180, 3}}), {0, 0}).x_step, 50.0);
}

TEST(CurvePlot, AxesOfCountsHaveTicksAtWholeNumbersAlone) {
  CurvePlot plot = chart({{0, 1}, {3, 2}});
  EXPECT_THAT(draw_curve(plot), HasSubstr(">0.5<"));
  plot.x_step_min = 1.0;
  plot.y_step_min = 1.0;
  for (const auto& points : {std::vector<core::Point2>{{0, 1}, {3, 2}}, {{4, 4}}, {{0, 90}, {1, 91}}}) {
    plot.series[0].points = points;
    EXPECT_THAT(draw_curve(plot), Not(ContainsRegex(">-?[0-9]+\\.[0-9]+<")));
  }
}

TEST(CurvePlot, PointsThatCannotBeDrawnBreakTheLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string svg =
      draw_curve(chart({{1, 10}, {2, 20}, {3, nan}, {4, 0}, {5, 50}, {6, 60}}, AxisScale::Logarithmic));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  const std::size_t end = svg.find("stroke=\"#0072b2\"", svg.find("<path"));
  const std::size_t start = svg.rfind("<path", end);
  const std::string path = svg.substr(start, end - start);
  EXPECT_EQ(std::count(path.begin(), path.end(), 'M'), 2);
}

TEST(CurvePlot, OnlyNamedSeriesStandInTheLegend) {
  CurvePlot plot = chart({{0, 1}, {1, 3}});
  EXPECT_THAT(draw_curve(plot), HasSubstr(">measured<"));
  plot.series[0].name.clear();
  EXPECT_THAT(draw_curve(plot), Not(HasSubstr(">measured<")));
}

TEST(CurvePlot, WithoutPointsThereAreAxes) {
  EXPECT_EQ(xml_fault(draw_curve({})), "");
}

}  // namespace
}  // namespace slamsensor::tools
