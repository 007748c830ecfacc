#include "core/detection/landmark_detector.hpp"
#include "tests/unit/core/detection/detection_support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace slamsensor::core {
namespace {

using detection_test::detect;
using detection_test::Scan;
using detection_test::Scanline;

struct Tree {
  Point2 centre_L;
  double radius_m;
  double height_m;  // above the sensor
};

/// Horizontal distance from the sensor to the tree's bark along a bearing; none when the beam passes it.
double bark_m(const Tree& tree, double pan_rad) {
  const Point2 beam(std::cos(pan_rad), std::sin(pan_rad));
  const double along_m = beam.dot(tree.centre_L);
  const double beside_m = beam.x() * tree.centre_L.y() - beam.y() * tree.centre_L.x();
  const double half_chord_squared = tree.radius_m * tree.radius_m - beside_m * beside_m;
  return along_m > 0.0 && half_chord_squared > 0.0 ? along_m - std::sqrt(half_chord_squared)
                                                   : Reading::kNoReturn;
}

/// A sensor that turns all the way round: `shots` readings a scanline, 21 scanlines of 0.5 deg from the
/// horizontal up.
Scan scan_of(const std::vector<Tree>& trees, int shots = 5000) {
  Scan scan;
  for (int line = 0; line < 21; ++line) {
    const double tilt_rad = 0.5 * line * kDegree;
    Scanline scanline;
    for (int shot = 0; shot < shots; ++shot) {
      const double pan_rad = (shot + 0.5) / shots * 2.0 * std::numbers::pi;
      double range_m = Reading::kNoReturn;
      for (const Tree& tree : trees) {
        const double distance_m = bark_m(tree, pan_rad);
        const double seen_m = distance_m / std::cos(tilt_rad);
        if (distance_m >= 0.0 && distance_m * std::tan(tilt_rad) <= tree.height_m &&
            (range_m < 0.0 || seen_m < range_m)) {
          range_m = seen_m;
        }
      }
      scanline.push_back({pan_rad, tilt_rad, range_m});
    }
    scan.push_back(scanline);
  }
  return scan;
}

DetectionConfig turning_config(LandmarkPoint point) {
  DetectionConfig config;
  config.discard_share = 0.0;
  config.point = point;
  return config;
}

Point2 polar(double distance_m, double bearing_rad) {
  return distance_m * Point2(std::cos(bearing_rad), std::sin(bearing_rad));
}

/// Along and across the line of sight to `truth`, m.
Point2 error_along_and_across(const Point2& found, const Point2& truth) {
  const Point2 along = truth.normalized();
  const Point2 error = found - truth;
  return {error.dot(along), along.x() * error.y() - along.y() * error.x()};
}

TEST(KnownTrees, OneTreeIsFoundWithinHalfACell) {
  const DetectionConfig config = turning_config(LandmarkPoint::HullCentroid);
  for (const double bearing_deg : {0.0, 30.0, 90.0, 181.7, 359.9}) {
    const Tree tree{polar(20.0, bearing_deg * kDegree), 0.15, 10.0};
    const auto found = detect(config, scan_of({tree}));
    ASSERT_EQ(found.size(), 1U) << bearing_deg;
    EXPECT_EQ(found[0].weight, 21.0) << bearing_deg;  // 10 m stand above all 21 scanlines at 20 m
    const Point2 error_m = error_along_and_across(found[0].position_L, tree.centre_L);
    // What is seen is the bark, between the centre and a radius before it.
    EXPECT_LT(error_m.x(), 0.5 * config.range_step_m) << bearing_deg;
    EXPECT_GT(error_m.x(), -0.5 * config.range_step_m - tree.radius_m) << bearing_deg;
    EXPECT_LT(std::abs(error_m.y()), 0.5 * config.bearing_step_rad * 20.0) << bearing_deg;
  }
}

TEST(KnownTrees, WeightIsTheScanlinesUpToTheTop) {
  // At 20 m a top 1.6 m above the sensor is at 4.6 deg: scanlines 0, 0.5, ... 4.5 deg see it, which are 10.
  // Only the outermost bark, farther by up to a radius, changes nothing at that margin.
  const Tree tree{polar(20.0, 1.0), 0.15, 1.6};
  const auto found = detect(turning_config(LandmarkPoint::HullCentroid), scan_of({tree}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].weight, 10.0);
}

TEST(KnownTrees, TallTreesWinAndHiddenOnesAreNotSeen) {
  const Tree tall{polar(15.0, 0.5), 0.2, 10.0};
  const Tree low{polar(12.0, 2.0), 0.2, 0.5};
  const Tree half_hidden{polar(25.0, 0.5 + 0.02), 0.4, 20.0};  // one side behind the tall one
  const auto found = detect(turning_config(LandmarkPoint::ReadingMean), scan_of({low, half_hidden, tall}));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_LT((found[0].position_L - tall.centre_L).norm(), 0.25);
  EXPECT_LT((found[1].position_L - low.centre_L).norm(), 0.25);
}

TEST(KnownTrees, ReadingMeanIsNearerThanHullCentroid) {
  const unsigned seed = 1618;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> distance_m(6.0, 60.0);
  std::uniform_real_distribution<double> bearing_rad(0.0, 2.0 * std::numbers::pi);
  double hull_squared = 0.0;
  double mean_squared = 0.0;
  constexpr int kTrees = 40;
  for (int i = 0; i < kTrees; ++i) {
    const Tree tree{polar(distance_m(random), bearing_rad(random)), 0.12, 30.0};
    const Scan scan = scan_of({tree});
    const auto hull = detect(turning_config(LandmarkPoint::HullCentroid), scan);
    const auto mean = detect(turning_config(LandmarkPoint::ReadingMean), scan);
    ASSERT_EQ(hull.size(), 1U);
    ASSERT_EQ(mean.size(), 1U);
    // The bark that is seen is a radius or less before the centre; no method that keeps to what it sees is
    // nearer.
    const Point2 error_m = error_along_and_across(mean[0].position_L, tree.centre_L);
    EXPECT_GT(error_m.x(), -tree.radius_m - 1e-6);
    EXPECT_LT(error_m.x(), 0.0);
    EXPECT_LT(std::abs(error_m.y()), tree.radius_m);
    hull_squared += (hull[0].position_L - tree.centre_L).squaredNorm();
    mean_squared += (mean[0].position_L - tree.centre_L).squaredNorm();
  }
  const double hull_rms_m = std::sqrt(hull_squared / kTrees);
  const double mean_rms_m = std::sqrt(mean_squared / kTrees);
  RecordProperty("hull_rms_mm", static_cast<int>(1000.0 * hull_rms_m));
  RecordProperty("mean_rms_mm", static_cast<int>(1000.0 * mean_rms_m));
  EXPECT_LT(mean_rms_m, 0.75 * hull_rms_m);
}

// Of many trees, as each alone is quantised by the columns.
TEST(KnownTrees, TheirDiameterIsMeasuredWhereTheyAreWiderThanAColumn) {
  const DetectionConfig config = turning_config(LandmarkPoint::ReadingMean);
  for (const int shots : {800, 1500, 5000}) {
    for (const double radius_m : {0.1, 0.2, 0.4}) {
      for (const double columns_wide : {4.0, 8.0, 15.0}) {
        const double distance_m = 2.0 * radius_m / (columns_wide * config.bearing_step_rad);
        double sum = 0.0;
        constexpr int kTrees = 20;
        for (int i = 0; i < kTrees; ++i) {
          const auto found =
              detect(config, scan_of({{polar(distance_m, 0.3 + 0.17 * i), radius_m, 10.0}}, shots));
          ASSERT_EQ(found.size(), 1U);
          sum += found[0].diameter_m / (2.0 * radius_m);
        }
        EXPECT_NEAR(sum / kTrees, 1.0, 0.4 / columns_wide)
            << shots << " readings, " << radius_m << " m, " << columns_wide << " columns";
      }
    }
  }
}

TEST(KnownTrees, WhatIsNoWiderThanAColumnHasNoDiameter) {
  const DetectionConfig config = turning_config(LandmarkPoint::ReadingMean);
  for (int i = 0; i < 20; ++i) {
    const auto found =
        detect(config, scan_of({{polar(20.0, (i + 0.5) * config.bearing_step_rad), 0.05, 10.0}}));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].diameter_m, 0.0) << i;
  }
}

}  // namespace
}  // namespace slamsensor::core
