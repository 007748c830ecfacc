#include "tools/plot/map_plot.hpp"

#include "tests/unit/tools/plot/xml_check.hpp"
#include "tools/plot/svg.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <limits>
#include <regex>

namespace slamsensor::tools {
namespace {

using core::FixStatus;
using testing::HasSubstr;
using testing::Not;

// A spiral path of `poses` steps among landmarks on a lattice.
MapPlot spiral(int poses, int landmarks, double step_m, double spacing_m) {
  MapPlot plot;
  plot.title = "Spiral";
  core::Pose2 pose;
  for (int i = 0; i < poses; ++i) {
    plot.poses.push_back({pose, i + 1, FixStatus::Fix});
    pose = pose * core::Pose2{step_m, 0.0, 2.0 / (5.0 + 0.2 * i)};
  }
  const int side = static_cast<int>(std::ceil(std::sqrt(landmarks)));
  for (int i = 0; i < landmarks; ++i) {
    PlotLandmark landmark;
    landmark.position_W = {spacing_m * (i % side - side / 2), spacing_m * (i / side - side / 2)};
    landmark.xi = static_cast<unsigned>(i) / 7U;
    plot.landmarks.push_back(landmark);
  }
  return plot;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

struct Number {
  std::string words;
  PixelBox box;
};

// The scan numbers of the picture's last panel, with their extents.
std::vector<Number> numbers_in(const std::string& svg) {
  const std::size_t start = svg.rfind("paint-order=\"stroke\"");
  const std::string group = svg.substr(start, svg.find("</g>", start) - start);
  const std::regex pattern("<text x=\"([-0-9.]+)\" y=\"([-0-9.]+)\">([-0-9]+)</text>");
  std::vector<Number> numbers;
  for (std::sregex_iterator it(group.begin(), group.end(), pattern); it != std::sregex_iterator(); ++it) {
    const double x = std::stod((*it)[1]);
    const double y = std::stod((*it)[2]);
    const double half = 0.5 * text_width_px(std::string((*it)[3]), 10.0);
    numbers.push_back({(*it)[3], {x - half, y - 7.5, x + half, y}});
  }
  return numbers;
}

class MapPlotSizes : public testing::TestWithParam<std::tuple<int, int, double, double>> {
 protected:
  MapPlot plot() const {
    const auto [poses, landmarks, step_m, spacing_m] = GetParam();
    return spiral(poses, landmarks, step_m, spacing_m);
  }
};

TEST_P(MapPlotSizes, IsWellFormed) {
  EXPECT_EQ(xml_fault(draw_map(plot())), "");
}

TEST_P(MapPlotSizes, SameBytesForTheSamePlot) {
  EXPECT_EQ(draw_map(plot()), draw_map(plot()));
}

TEST_P(MapPlotSizes, NumbersNeverOverlapAndFirstAndLastAreThere) {
  const MapPlot drawn = plot();
  const std::vector<Number> numbers = numbers_in(draw_map(drawn));
  ASSERT_GE(numbers.size(), 2U);
  EXPECT_EQ(numbers[0].words, "1");
  EXPECT_EQ(numbers[1].words, std::to_string(drawn.poses.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(numbers[i].box.overlaps(numbers[j].box))
          << numbers[i].words << " and " << numbers[j].words;
    }
  }
}

TEST_P(MapPlotSizes, AxesAreEqualAndEverythingIsInside) {
  const MapPlot drawn = plot();
  const MapPanel frame = frame_map(drawn, {});
  const core::Point2 range_m = frame.high_W - frame.low_W;
  EXPECT_NEAR(frame.area.width() / range_m.x(), frame.area.height() / range_m.y(), 1e-9);
  for (const PlotPose& pose : drawn.poses) {
    EXPECT_TRUE(frame.area.contains(box_around(frame.to_px(pose.pose_W.translation()), 4.0)));
  }
  for (const PlotLandmark& landmark : drawn.landmarks) {
    EXPECT_TRUE(frame.area.contains(box_around(frame.to_px(landmark.position_W), 4.0)));
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, MapPlotSizes,
                         testing::Values(std::tuple{5, 30, 3.0, 6.0}, std::tuple{56, 90, 0.3, 8.0},
                                         std::tuple{56, 40, 0.3, 1.0}, std::tuple{1200, 2000, 0.5, 1.5},
                                         std::tuple{300, 400, 5.0, 12.0}, std::tuple{2, 0, 1e-6, 1.0}));

TEST(MapPlot, SmallPathIsShownAgainLarger) {
  EXPECT_EQ(count(draw_map(spiral(56, 90, 0.3, 8.0)), ">x (m)<"), 2U);
  EXPECT_EQ(count(draw_map(spiral(5, 30, 3.0, 6.0)), ">x (m)<"), 1U);
}

// The texts under which the scale bars stand, by their x, and the length that each says, m.
std::vector<std::pair<double, double>> scale_bars(const std::string& svg) {
  const std::regex pattern("<text x=\"([-0-9.]+)\"[^>]*>([0-9.]+) m</text>");
  std::vector<std::pair<double, double>> bars;
  for (std::sregex_iterator it(svg.begin(), svg.end(), pattern); it != std::sregex_iterator(); ++it) {
    bars.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return bars;
}

TEST(MapPlot, EachOfTwoPanelsHasItsOwnScaleBarInside) {
  EXPECT_EQ(scale_bars(draw_map(spiral(5, 30, 3.0, 6.0))).size(), 1U);
  const auto bars = scale_bars(draw_map(spiral(56, 90, 0.3, 8.0)));
  ASSERT_EQ(bars.size(), 2U);
  constexpr double kMapWidthLeast_px = 340.0;
  EXPECT_LT(bars[0].first, kMapWidthLeast_px) << "in the map, at its left";
  EXPECT_GT(bars[1].first, kMapWidthLeast_px) << "in the detail";
  EXPECT_GT(bars[0].second, bars[1].second) << "the detail is larger: its bar is shorter in metres";
}

TEST(MapPlot, EmptyPlotHasAxesAndNoKey) {
  const std::string svg = draw_map({});
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_THAT(svg, HasSubstr("x (m)"));
  EXPECT_THAT(svg, Not(HasSubstr("landmark")));
  EXPECT_THAT(svg, Not(HasSubstr("path, pose")));
}

TEST(MapPlot, OnePoseIsNumberedOnce) {
  MapPlot plot;
  plot.poses.push_back({{1e5, -2e5, 0.5}, 77, FixStatus::Fix});
  EXPECT_EQ(count(draw_map(plot), ">77<"), 1U);
}

TEST(MapPlot, AmbiguousPosesAreHollowAndNamedInTheKey) {
  MapPlot plot = spiral(5, 0, 1.0, 1.0);
  EXPECT_THAT(draw_map(plot), Not(HasSubstr("ambiguous pose")));
  const std::size_t before = count(draw_map(plot), "<circle");
  plot.poses[2].status = FixStatus::Ambiguous;
  const std::string svg = draw_map(plot);
  EXPECT_THAT(svg, HasSubstr("ambiguous pose"));
  EXPECT_EQ(count(svg, "<circle"), before + 1) << "the key's, and the same number in the map";
  EXPECT_EQ(count(svg, "fill=\"#ffffff\" stroke="), 2U);
}

TEST(MapPlot, AScanWithoutFixBreaksThePath) {
  MapPlot plot = spiral(6, 0, 1.0, 1.0);
  const auto moves = [&](const std::string& svg) {
    const std::size_t end = svg.find("stroke-linejoin=\"round\"/>");
    const std::size_t start = svg.rfind("<path", end);
    const std::string path = svg.substr(start, end - start);
    return count(path, "M");
  };
  EXPECT_EQ(moves(draw_map(plot)), 1U);
  plot.poses[3].status = FixStatus::NoFix;
  EXPECT_EQ(moves(draw_map(plot)), 2U);
}

TEST(MapPlot, MatchesAndTruthAreDrawnAndNamed) {
  MapPlot plot = spiral(5, 9, 1.0, 2.0);
  plot.landmarks[0].matched = plot.landmarks[4].matched = true;
  plot.truth_W = {{0, 0, 0}, {1, 0, 0}};
  const std::string svg = draw_map(plot);
  EXPECT_THAT(svg, HasSubstr("matched by last pose"));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray=\"4 2.5\""));
  EXPECT_THAT(svg, HasSubstr(">truth<"));
}

TEST(MapPlot, WhatIsNotFiniteIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  MapPlot plot = spiral(5, 9, 1.0, 2.0);
  plot.landmarks.push_back({{nan, 0.0}, 3, true});
  plot.poses.push_back({{0.0, infinite, 0.0}, 6, FixStatus::Fix});
  plot.truth_W.push_back({0.0, 0.0, nan});
  const std::string svg = draw_map(plot);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(MapPlot, TitleIsEscapedAndWrapped) {
  MapPlot plot = spiral(5, 9, 1.0, 2.0);
  plot.title = "a <b> & \xFF";
  plot.summary = {std::string(300, 'w') + " tail"};
  const std::string svg = draw_map(plot);
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_THAT(svg, HasSubstr("a &lt;b&gt; &amp; ?"));
  EXPECT_THAT(svg, HasSubstr(">tail<"));
}

TEST(MapPlot, LocaleChangesNothing) {
  const std::string expected = draw_map(spiral(5, 9, 1.0, 2.0));
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"}) {
    if (!std::setlocale(LC_ALL, locale)) continue;
    EXPECT_EQ(draw_map(spiral(5, 9, 1.0, 2.0)), expected) << locale;
  }
  std::setlocale(LC_ALL, "C");
}

TEST(SvgWriter, Golden) {
  SvgWriter svg;
  PathData path;
  path.plus({5.0, -0.001}, 1.0);
  svg.path(path, "stroke=\"#000000\"");
  svg.path(PathData{});
  svg.text({1.0, 2.5}, "a&b");
  EXPECT_EQ(
      svg.finish(20.4, 10.0),
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" "
      "height=\"10\" viewBox=\"0 0 20 10\" font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', "
      "sans-serif\" font-size=\"11\" fill=\"none\">\n<rect width=\"20\" height=\"10\" fill=\"#ffffff\"/>\n"
      "<path d=\"M4.00 0.00L6.00 0.00M5.00 -1.00L5.00 1.00\" stroke=\"#000000\"/>\n"
      "<text x=\"1.00\" y=\"2.50\">a&amp;b</text>\n</svg>\n");
}

}  // namespace
}  // namespace slamsensor::tools
