// What a scan saw free, beside its landmarks.
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
using detection_test::Scanline;

constexpr double kNone = Reading::kNoReturn;

/// One reading per column of hand_config() at `range_m`, but where `ranges` says; columns of `left_out` have
/// none.
Scanline line_of(double range_m, const std::vector<std::pair<std::uint32_t, double>>& ranges,
                 const std::vector<std::uint32_t>& left_out = {}) {
  Scanline scanline;
  for (std::uint32_t column = 0; column < 20; ++column) {
    double here_m = range_m;
    for (const auto& [other, other_m] : ranges) {
      here_m = other == column ? other_m : here_m;
    }
    if (std::find(left_out.begin(), left_out.end(), column) == left_out.end()) {
      scanline.push_back({middle_rad(hand_config(), column), 0.0, here_m});
    }
  }
  return scanline;
}

TEST(DetectorView, ATrunkEndsWhatIsFreeAndAWallOverItDoesNot) {
  Detector detector(hand_config());
  // Column 3: a trunk in front of a wall in all scanlines. Column 5: a bush, over which three scanlines see
  // the wall. Column 7: a trunk over which only two do.
  (void)detect(
      *detector,
      {line_of(40.5, {{3, 10.5}, {5, 10.5}, {7, 10.5}}), line_of(40.5, {{3, 10.5}, {5, 10.5}, {7, 10.5}}),
       line_of(40.5, {{3, 10.5}, {7, 10.5}}), line_of(40.5, {{3, 10.5}}), line_of(40.5, {{3, 10.5}})});
  const ScanView view = detector->view();
  ASSERT_EQ(view.free_m.size(), 20U);
  EXPECT_NEAR(view.free_m[3], 10.5, 0.51);
  EXPECT_NEAR(view.free_m[5], 40.5, 0.51);
  EXPECT_NEAR(view.free_m[7], 10.5, 0.51);
  EXPECT_NEAR(view.free_m[12], 40.5, 0.51);
}

TEST(DetectorView, NoReturnIsFreeToTheLargestRange) {
  Detector detector(hand_config());
  (void)detect(*detector,
               {line_of(kNone, {{3, 10.5}}), line_of(kNone, {{3, 10.5}}), line_of(kNone, {{3, 10.5}})});
  const ScanView view = detector->view();
  EXPECT_EQ(view.range_m, hand_config().range_max_m);
  EXPECT_NEAR(view.free_m[3], 10.5, 0.51);
  EXPECT_EQ(view.free_m[4], static_cast<float>(hand_config().range_max_m));
  EXPECT_TRUE(view.shows({0.0, 5.0}, 0.3));
}

TEST(DetectorView, WhatWasNotLookedAtIsNotKnown) {
  Detector detector(hand_config());
  (void)detect(*detector, {line_of(40.5, {}, {9, 10}), line_of(40.5, {}, {9, 10}), line_of(40.5, {}, {10})});
  const ScanView view = detector->view();
  EXPECT_NEAR(view.free_m[9], 40.5, 0.51) << "one scanline looked";
  EXPECT_EQ(view.free_m[10], ScanView::kUnknown);
  EXPECT_FALSE(view.shows(
      5.0 * Point2(std::cos(middle_rad(hand_config(), 10)), std::sin(middle_rad(hand_config(), 10))), 0.1));
}

TEST(DetectorView, IsThatOfTheLastScanAlone) {
  Detector detector(hand_config());
  (void)detect(*detector, {line_of(40.5, {}), line_of(40.5, {}), line_of(40.5, {})});
  (void)detect(*detector, {line_of(20.5, {}, {0})});
  const ScanView view = detector->view();
  EXPECT_EQ(view.free_m[0], ScanView::kUnknown);
  EXPECT_NEAR(view.free_m[1], 20.5, 0.51);
  (void)detector->finish();
  EXPECT_EQ(detector->view().free_m[1], ScanView::kUnknown);
}

// A scanline that the detector leaves out for its tilt has not looked either.
TEST(DetectorView, ScanlinesThatAreLeftOutHaveNotLooked) {
  DetectionConfig config = hand_config();
  config.tilt_min_rad = -0.1;
  config.tilt_max_rad = 0.1;
  Detector detector(config);
  Scanline high = line_of(40.5, {});
  for (Reading& reading : high) {
    reading.tilt_rad = 0.5;
  }
  (void)detect(*detector, {high, high, high});
  for (const float free_m : detector->view().free_m) {
    EXPECT_EQ(free_m, ScanView::kUnknown);
  }
}

}  // namespace
}  // namespace slamsensor::core
