#include "tools/input/text_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

using firmware::LandmarkListConfig;
using firmware::LandmarkOrder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string error_of(std::string_view text) {
  const auto list = parse_landmark_csv(text, "l.csv");
  return list ? "" : list.error().message;
}

// x of what is selected, which names the landmark in these tests.
std::vector<double> selected(std::string_view text, const LandmarkListConfig& config,
                             const core::DetectionConfig& detection = {}) {
  const auto list = parse_landmark_csv(text, "l.csv");
  EXPECT_TRUE(list);
  std::vector<double> xs_m;
  for (const core::ScanLandmark& landmark : select_landmarks(list->rows, config, detection).landmarks) {
    xs_m.push_back(landmark.position_L.x());
  }
  return xs_m;
}

constexpr const char* kTrees =
    "scan,x_m,y_m,diameter_m,weight\n0,1,0,0.3,0.5\n0,-2,0,0.4,0.9\n0,3,0,0.1,0.5\n0,500,0,0.9,0.9\n";

TEST(LandmarkCsv, GathersTheRowsOfAScanFromAnywhere) {
  const auto list = parse_landmark_csv("y_m,x_m,scan\n1,10,5\n2,20,3\n3,30,5\n", "l.csv");
  ASSERT_TRUE(list);
  EXPECT_FALSE(list->has_diameter);
  EXPECT_FALSE(list->has_weight);
  ASSERT_EQ(list->rows.size(), 3U);
  EXPECT_EQ(list->rows[0].scan, 3);
  EXPECT_EQ(list->rows[1].position_L, core::Point2(10, 1));
  EXPECT_EQ(list->rows[2].position_L, core::Point2(30, 3));
  EXPECT_EQ(list->rows[2].weight, 1.0);
}

TEST(LandmarkCsv, SaysLineValueAndWhatIsAllowed) {
  const std::string head = "scan,x_m,y_m\n";
  EXPECT_THAT(error_of(head), HasSubstr("holds no landmark"));
  EXPECT_THAT(error_of(head + "1.5,0,0\n"), AllOf(HasSubstr("l.csv:2"), HasSubstr("scan is '1.5'")));
  EXPECT_THAT(error_of(head + "-1,0,0\n"), HasSubstr("scan is '-1'"));
  EXPECT_THAT(error_of(head + "9000000001,0,0\n"), HasSubstr("9000000000"));
  EXPECT_THAT(error_of(head + "1,nan,0\n"), HasSubstr("x_m is 'nan'"));
  EXPECT_THAT(error_of(head + "1,0,20000\n"), HasSubstr("y_m is '20000'"));
  EXPECT_THAT(error_of("scan,x_m,y_m,weight\n1,0,0,-2\n"), HasSubstr("weight is '-2'"));
  EXPECT_THAT(error_of("scan,x_m,y_m,diameter_m\n1,0,0,\n"), HasSubstr("diameter_m is ''"));
  EXPECT_THAT(error_of("scan,x_m,y_m,height\n1,0,0,2\n"), HasSubstr("'height' is not known"));
}

TEST(LandmarkCsv, OrdersByWeightDiameterOrNearnessTiesAsInTheFile) {
  EXPECT_THAT(selected(kTrees, {LandmarkOrder::Weight, 0, 0}), ElementsAre(-2, 1, 3));
  EXPECT_THAT(selected(kTrees, {LandmarkOrder::Diameter, 0, 0}), ElementsAre(-2, 1, 3));
  EXPECT_THAT(selected(kTrees, {LandmarkOrder::Nearest, 0, 0}), ElementsAre(1, -2, 3));
  EXPECT_THAT(selected("scan,x_m,y_m\n0,3,0\n0,1,0\n0,2,0\n", {}), ElementsAre(3, 1, 2));
}

TEST(LandmarkCsv, TheWeightOfALandmarkIsWhatOrdersIt) {
  const auto list = parse_landmark_csv(kTrees, "l.csv");
  ASSERT_TRUE(list);
  EXPECT_EQ(select_landmarks(list->rows, {LandmarkOrder::Diameter, 0, 0}, {}).landmarks.front().weight, 0.4);
  EXPECT_EQ(select_landmarks(list->rows, {LandmarkOrder::Nearest, 0, 0}, {}).landmarks.back().weight, -3.0);
}

TEST(LandmarkCsv, AppliesMinimumsReachAndCapacity) {
  EXPECT_THAT(selected(kTrees, {LandmarkOrder::Nearest, 0.6, 0}), ElementsAre(-2));
  EXPECT_THAT(selected(kTrees, {LandmarkOrder::Nearest, 0, 0.2}), ElementsAre(1, -2));
  core::DetectionConfig detection;
  detection.range_max_m = 1000;
  detection.landmarks_max = 2;
  EXPECT_THAT(selected(kTrees, {LandmarkOrder::Diameter, 0, 0}, detection), ElementsAre(500, -2));
}

core::DetectionConfig at_most(std::uint32_t landmarks) {
  core::DetectionConfig detection;
  detection.landmarks_max = landmarks;
  return detection;
}

// A list of far trees first lost its near ones without a word, and what was left fitted elsewhere.
TEST(LandmarkCsv, OfEqualWeightsTheNearestHaveRoom) {
  EXPECT_THAT(selected("scan,x_m,y_m\n0,30,0\n0,-5,0\n0,20,0\n0,1,0\n", {}, at_most(2)), ElementsAre(1, -5));
  const char* const weighed = "scan,x_m,y_m,weight\n0,30,0,7\n0,20,0,2\n0,-5,0,2\n0,9,0,2\n0,1,0,1\n";
  EXPECT_THAT(selected(weighed, {}, at_most(3)), ElementsAre(30, -5, 9));
  EXPECT_THAT(selected(weighed, {}, at_most(1)), ElementsAre(30));
  EXPECT_THAT(selected(weighed, {}, at_most(4)), ElementsAre(30, -5, 9, 20));
}

TEST(LandmarkCsv, CountsWhatHasNoRoom) {
  const auto list = parse_landmark_csv("scan,x_m,y_m\n0,30,0\n0,-5,0\n0,20,0\n0,1,0\n0,900,0\n", "l.csv");
  ASSERT_TRUE(list);
  EXPECT_EQ(select_landmarks(list->rows, {}, at_most(3)).beyond_max, 1U) << "one is out of reach";
  EXPECT_EQ(select_landmarks(list->rows, {}, at_most(4)).beyond_max, 0U);
}

// Rows of one place were so many witnesses for it.
TEST(LandmarkCsv, APlaceCountsOnce) {
  const auto list = parse_landmark_csv(
      "scan,x_m,y_m,weight\n0,1,2,1\n0,1,2,3\n0,1.0004,2,2\n0,1.0000,2.0000,1\n0,1.002,2,1\n0,-1,2,1\n",
      "l.csv");
  ASSERT_TRUE(list);
  const ListScan scan = select_landmarks(list->rows, {}, {});
  EXPECT_EQ(scan.at_one_place, 3U);
  ASSERT_EQ(scan.landmarks.size(), 3U);
  EXPECT_EQ(scan.landmarks[0].weight, 3.0) << "the heaviest of them stands for the place";
  EXPECT_EQ(scan.landmarks[1].position_L.x(), 1.002);
  EXPECT_EQ(scan.beyond_max, 0U);
}

TEST(LandmarkCsv, RefusesAnOrderOrMinimumWhoseColumnIsMissing) {
  const LandmarkList bare;
  const auto message = [&](const LandmarkListConfig& config) {
    const auto checked = check_landmark_columns(bare, "l.csv", config);
    return checked ? "" : checked.error().message;
  };
  EXPECT_EQ(message({LandmarkOrder::Weight, 1.0, 0}), "");
  EXPECT_EQ(message({LandmarkOrder::Nearest, 0, 0}), "");
  EXPECT_THAT(message({LandmarkOrder::Diameter, 0, 0}), HasSubstr("no column diameter_m"));
  EXPECT_THAT(message({LandmarkOrder::Weight, 0, 0.1}), HasSubstr("least diameter of 0.1 m"));
  EXPECT_THAT(message({LandmarkOrder::Weight, 2, 0}), HasSubstr("no column weight"));
}

}  // namespace
}  // namespace slamsensor::tools
