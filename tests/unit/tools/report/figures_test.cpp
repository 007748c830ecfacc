#include "tests/unit/tools/plot/xml_check.hpp"
#include "tools/report/correspondence_figure.hpp"
#include "tools/report/scan_figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {
namespace {

std::size_t count_of(std::string_view text, std::string_view word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

/// Scanlines that see posts of 0.3 m radius, and nothing else; the lowest sees the ground at 8 m, too.
Scanlines posts_seen(const std::vector<core::Point2>& posts) {
  Scanlines scanlines;
  for (int line = 0; line < 4; ++line) {
    std::vector<core::Reading> readings;
    for (int i = -1200; i <= 1200; ++i) {
      const double pan_rad = 0.1 * i * core::kDegree;
      double range_m = line == 0 ? 8.0 : core::Reading::kNoReturn;
      for (const core::Point2& post : posts) {
        const double off_rad = core::wrap_angle(pan_rad - std::atan2(post.y(), post.x()));
        if (std::abs(off_rad) < std::atan(0.3 / post.norm()) && (line > 0 || post.norm() < 8.0)) {
          range_m = post.norm();
        }
      }
      readings.push_back({pan_rad, 0.01 * line, range_m});
    }
    scanlines.push_back(readings);
  }
  return scanlines;
}

const std::vector<core::Point2> kPosts{{6.0, 1.0}, {4.0, -7.0}, {15.0, 9.0}, {22.0, -6.0}, {-3.0, 12.0}};

TEST(ScanFigures, TheSpiderwebShowsEachPostAsALandmark) {
  const core::DetectionConfig config;
  const std::string svg = draw_spiderweb(posts_seen(kPosts), config, "five posts");
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_NE(svg.find("the 5 heaviest groups are landmarks"), std::string::npos) << svg.substr(0, 2000);
  EXPECT_EQ(count_of(svg, "r=\"5.5"), 5U + 1U) << "five circles and that of the legend";
}

TEST(ScanFigures, ALegendThatIsTooLongForOneRowGoesOnInAnother) {
  Scanlines many;
  for (int i = 0; i < 5; ++i) {
    for (const std::vector<core::Reading>& line : posts_seen(kPosts)) many.push_back(line);
  }
  const std::string svg = draw_spiderweb(many, core::DetectionConfig(), "many scanlines");
  const auto place_of = [&](std::string_view word) {
    const std::size_t begin = svg.rfind("<text", svg.find(word));
    double x = 0.0;
    double y = 0.0;
    EXPECT_EQ(std::sscanf(svg.c_str() + begin, "<text x=\"%lf\" y=\"%lf\"", &x, &y), 2) << word;
    return core::Point2(x, y);
  };
  EXPECT_LT(place_of(">landmark<").x(), 600.0);
  EXPECT_GT(place_of(">landmark<").y(), place_of(">scanlines:<").y() + 10.0);
}

TEST(ScanFigures, AScanlineShowsItsClustersTheOtherReturnsAndWhatHasNone) {
  const core::DetectionConfig config;
  const Scanlines scanlines = posts_seen(kPosts);
  const auto richest = richest_scanline(scanlines, config);
  ASSERT_TRUE(richest);
  EXPECT_GT(*richest, 0U) << "the ground hides what is behind it";
  const std::string svg = draw_scanline(scanlines[*richest], config, "a line");
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_NE(svg.find(" 0 with other returns"), std::string::npos);
  const std::string low = draw_scanline(scanlines[0], config, "the lowest");
  EXPECT_EQ(low.find(" 0 with other returns"), std::string::npos);
}

TEST(ScanFigures, OfNoScanlineNoneIsTheRichest) {
  EXPECT_FALSE(richest_scanline({}, core::DetectionConfig()));
  EXPECT_EQ(xml_fault(draw_spiderweb({}, core::DetectionConfig(), "nothing")), "");
}

// Sides 3, 4, 5: each edge agrees with itself alone, in both directions.
TEST(CorrespondenceFigure, ATriangleAgreesWithItself) {
  const std::vector<core::Point2> triangle{{0.0, 0.0}, {3.0, 0.0}, {0.0, 4.0}};
  core::AssociationConfig config;
  config.tolerance_m = 0.2;
  const CorrespondenceGraph graph = correspondence_graph(triangle, triangle, config);
  EXPECT_EQ(graph.edges.size(), 6U);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(graph.degree[i * 3 + j], i == j ? 2U : 1U) << i << ' ' << j;
    }
  }
}

TEST(CorrespondenceFigure, WhatBelongsTogetherIsMarked) {
  std::vector<core::ScanLandmark> scan;
  std::vector<core::ScanLandmark> other;
  const core::Pose2 moved{1.0, -2.0, 0.4};
  for (int i = 0; i < 18; ++i) {
    const core::Point2 place(20.0 * std::sin(1.7 * i * i), 20.0 * std::cos(2.3 * i * i + 0.5 * i));
    other.push_back({place, 30.0 - i});
    scan.push_back({moved.inverse() * place, 30.0 - i});
  }
  core::Config config;
  const std::string svg = draw_correspondences(scan, other, config, "two scans");
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_NE(svg.find("18 pairs belong together"), std::string::npos) << svg.substr(0, 1500);
  std::vector<core::ScanLandmark> foreign = other;
  for (core::ScanLandmark& landmark : foreign) {
    landmark.position_L = landmark.position_L.cwiseProduct(core::Point2(1.7, -0.6)) + core::Point2(3.0, 40.0);
  }
  EXPECT_NE(draw_correspondences(scan, foreign, config, "strangers").find("there is no fix"),
            std::string::npos);
}

TEST(CorrespondenceFigure, OfTooFewLandmarksThereIsAPictureWithoutEdges) {
  const std::vector<core::ScanLandmark> one{{{1.0, 2.0}, 1.0}};
  EXPECT_EQ(xml_fault(draw_correspondences(one, one, core::Config(), "one")), "");
}

}  // namespace
}  // namespace slamsensor::tools
