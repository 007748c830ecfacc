#include "core/detection/landmark_detector.hpp"

#include "tests/unit/core/detection/detection_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace slamsensor::core {
namespace {

using detection_test::detect;
using detection_test::Detector;
using detection_test::hand_config;
using detection_test::middle_rad;
using detection_test::Scan;
using detection_test::Scanline;

constexpr double kNone = Reading::kNoReturn;

/// One reading in the middle of each of the 20 columns of hand_config(): no return but where `ranges` says.
Scanline line_of(const std::vector<std::pair<std::uint32_t, double>>& ranges) {
  Scanline scanline;
  for (std::uint32_t column = 0; column < 20; ++column) {
    scanline.push_back({middle_rad(hand_config(), column), 0.0, kNone});
  }
  for (const auto& [column, range_m] : ranges) {
    scanline[column].range_m = range_m;
  }
  return scanline;
}

Point2 polar(double distance_m, double bearing_rad) {
  return distance_m * Point2(std::cos(bearing_rad), std::sin(bearing_rad));
}

TEST(LandmarkDetector, WeightIsTheHeightInScanlines) {
  DetectionConfig config = hand_config();
  config.point = LandmarkPoint::ReadingMean;
  const auto found = detect(config, {
                                        line_of({{3, 10.5}, {8, 30.5}, {15, 40.5}}),
                                        line_of({{3, 10.5}, {8, 30.5}, {9, 30.5}}),
                                        line_of({{3, 10.5}}),
                                    });
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].weight, 3.0);
  EXPECT_LT((found[0].position_L - polar(10.5, middle_rad(config, 3))).norm(), 1e-12);
  EXPECT_EQ(found[1].weight, 1.5);  // cell (30, 8) twice, cell (30, 9) once
  EXPECT_EQ(found[2].weight, 1.0);
  EXPECT_LT((found[2].position_L - polar(40.5, middle_rad(config, 15))).norm(), 1e-12);
}

TEST(LandmarkDetector, AMomentsObstructionCostsWeightOnly) {
  // A trunk that two of its three scanlines see unobstructed; in the third a branch hangs in front of its
  // neighbour.
  const auto found = detect(hand_config(), {
                                               line_of({{3, 10.5}}),
                                               line_of({{3, 10.5}, {4, 5.5}}),
                                               line_of({{3, 10.5}}),
                                           });
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].weight, 2.0);
  EXPECT_EQ(found[1].weight, 1.0);
}

TEST(LandmarkDetector, GroupAcrossTheSeamIsOneLandmarkAtTheSeam) {
  const auto found = detect(hand_config(), {line_of({{19, 10.5}, {0, 10.5}})});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].position_L.y(), 0.0, 1e-12);
  EXPECT_GT(found[0].position_L.x(), 10.0);
  EXPECT_LT(found[0].position_L.x(), 11.0);
}

TEST(LandmarkDetector, GroupAtTheOriginIsFound) {
  const auto found = detect(hand_config(), {line_of({{3, 0.0}, {4, 0.5}, {5, 1.5}})});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].position_L.allFinite());
  EXPECT_LT(found[0].position_L.norm(), 2.0);
  EXPECT_EQ(found[0].weight, 1.0);
}

TEST(LandmarkDetector, AWallAllRoundIsNoLandmark) {
  Scanline wall = line_of({});
  for (Reading& reading : wall) {
    reading.range_m = 10.5;
  }
  EXPECT_TRUE(detect(hand_config(), {wall, wall}).empty());
}

TEST(LandmarkDetector, KeepsTheHeaviestUpToMk) {
  DetectionConfig config = hand_config();
  const Scan scan{line_of({{3, 10.5}, {8, 30.5}, {15, 40.5}}), line_of({{8, 30.5}, {15, 40.5}}),
                  line_of({{15, 40.5}})};
  for (const std::uint32_t landmarks_max : {1U, 2U, 3U, 4U}) {
    config.landmarks_max = landmarks_max;
    const auto found = detect(config, scan);
    ASSERT_EQ(found.size(), std::min(landmarks_max, 3U));
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].weight, 3.0 - static_cast<double>(i));
    }
  }
}

TEST(LandmarkDetector, FinishWithoutScanlinesIsEmpty) {
  Detector detector(hand_config());
  EXPECT_TRUE(detector->finish().empty());
  detector->add_scanline({});
  EXPECT_TRUE(detector->finish().empty());
}

TEST(LandmarkDetector, FullCapacityDropsCountsAndRecovers) {
  Capacities capacities;
  capacities.occupied_cells = 2;
  Detector detector(hand_config(), capacities);
  const Scan scan{line_of({{3, 10.5}, {8, 30.5}, {15, 40.5}})};
  EXPECT_EQ(detect(*detector, scan).size(), 2U);
  EXPECT_EQ(detector->cells_dropped(), 1U);
  EXPECT_EQ(detect(*detector, {line_of({{15, 40.5}})}).size(), 1U);
  EXPECT_EQ(detector->cells_dropped(), 1U);
}

}  // namespace
}  // namespace slamsensor::core
