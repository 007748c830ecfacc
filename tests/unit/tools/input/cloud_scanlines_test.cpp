#include "tools/input/pcd.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

namespace slamsensor::tools {
namespace {

using core::kDegree;
using core::Reading;
using testing::HasSubstr;

constexpr double kStep_rad = 0.514 * kDegree;
constexpr std::size_t kColumns = 701;

Eigen::Vector3d direction(double pan_rad, double tilt_rad) {
  return {std::cos(tilt_rad) * std::cos(pan_rad), std::cos(tilt_rad) * std::sin(pan_rad), std::sin(tilt_rad)};
}

firmware::PointCloudConfig only_points() {
  firmware::PointCloudConfig config;
  config.absent_is_no_return = false;
  return config;
}

std::size_t column_of(const Reading& reading) {
  return static_cast<std::size_t>(std::floor(reading.pan_rad / kStep_rad));
}

TEST(CloudScanlines, OneForEachRingSortedByPanAroundTheWholeTurn) {
  PointCloud cloud;
  cloud.has_ring = true;
  cloud.points = {{{0, -5, 0}, 9}, {{3, 0, 4}, 2}, {{0, 2, 0}, 9}, {{7, -1e-300, 0}, 9}};
  const auto scanlines = scanlines_of_cloud(cloud, only_points(), kStep_rad, "c").value();
  ASSERT_EQ(scanlines.size(), 2U);
  ASSERT_EQ(scanlines[0].size(), 1U);
  EXPECT_DOUBLE_EQ(scanlines[0][0].tilt_rad, std::atan2(4, 3));
  EXPECT_DOUBLE_EQ(scanlines[0][0].range_m, 5.0);
  ASSERT_EQ(scanlines[1].size(), 3U);
  EXPECT_EQ(scanlines[1][0].pan_rad, 0.0) << "not 2 pi";
  EXPECT_DOUBLE_EQ(scanlines[1][1].pan_rad, 90 * kDegree);
  EXPECT_DOUBLE_EQ(scanlines[1][2].pan_rad, 270 * kDegree);
  EXPECT_DOUBLE_EQ(scanlines[1][2].range_m, 5.0);
}

TEST(CloudScanlines, WithoutRingsOneForEachStepOfElevation) {
  PointCloud cloud;
  for (const double tilt_deg : {0.2, -0.2, 0.4, 1.1}) {
    cloud.points.push_back({10.0 * direction(1.0, tilt_deg * kDegree), 0});
  }
  const auto scanlines = scanlines_of_cloud(cloud, only_points(), kStep_rad, "c").value();
  ASSERT_EQ(scanlines.size(), 3U);
  EXPECT_EQ(scanlines[0].size(), 2U);
  EXPECT_NEAR(scanlines[1][0].tilt_rad, 0.4 * kDegree, 1e-12);
  EXPECT_NEAR(scanlines[2][0].tilt_rad, 1.1 * kDegree, 1e-12);
}

// As in a cloud of floats that was moved to its map and back.
TEST(CloudScanlines, RoundingScattersNoScanlineAtAMultipleOfTheStep) {
  PointCloud cloud;
  for (const double tilt_deg : {-2.0, -1.5, 0.0, 0.5}) {
    for (const double rounding : {-1e-6, 0.0, 1e-6}) {
      cloud.points.push_back({10.0 * direction(1.0, (tilt_deg + rounding) * kDegree), 0});
    }
  }
  const auto scanlines = scanlines_of_cloud(cloud, only_points(), kStep_rad, "c").value();
  ASSERT_EQ(scanlines.size(), 4U);
  for (const auto& scanline : scanlines) {
    EXPECT_EQ(scanline.size(), 3U);
  }
}

TEST(CloudScanlines, TheAttitudeIsTakenOut) {
  firmware::PointCloudConfig config = only_points();
  config.roll_rad = 0.1;
  config.pitch_rad = -0.2;
  const Eigen::Vector3d level(4, 3, 1);
  const Eigen::Matrix3d attitude =
      (Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  PointCloud cloud;
  cloud.points = {{attitude.transpose() * level, 0}};
  const Reading reading = scanlines_of_cloud(cloud, config, kStep_rad, "c").value()[0][0];
  EXPECT_NEAR(reading.pan_rad, std::atan2(3, 4), 1e-12);
  EXPECT_NEAR(reading.tilt_rad, std::atan2(1, 5), 1e-12);
  EXPECT_NEAR(reading.range_m, std::sqrt(26.0), 1e-12);
}

TEST(CloudScanlines, ASensorPitchedNoseDownSeesTheHorizonAboveItsAxis) {
  firmware::PointCloudConfig config = only_points();
  config.pitch_rad = 10 * kDegree;
  PointCloud cloud;
  cloud.points = {{direction(0, 0), 0}};  // straight ahead of the sensor, so 10 deg below the horizon
  EXPECT_NEAR(scanlines_of_cloud(cloud, config, kStep_rad, "c").value()[0][0].tilt_rad, -10 * kDegree, 1e-12);
}

TEST(CloudScanlines, EveryColumnOfAScanlineIsLookedAtOnceOrByItsPoints) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> pan_rad(0, 2 * std::numbers::pi);
    PointCloud cloud;
    cloud.has_ring = true;
    for (std::uint32_t i = 0; i < 900; ++i) {
      cloud.points.push_back({20.0 * direction(pan_rad(random), 0.1 * (i % 3)), i % 3});
    }
    const auto scanlines = scanlines_of_cloud(cloud, {}, kStep_rad, "c").value();
    ASSERT_EQ(scanlines.size(), 3U);
    std::size_t returns = 0;
    for (const auto& scanline : scanlines) {
      std::set<std::size_t> hit, absent;
      double before_rad = -1.0;
      for (const Reading& reading : scanline) {
        EXPECT_LE(before_rad, reading.pan_rad);
        before_rad = reading.pan_rad;
        EXPECT_LT(reading.pan_rad, 2 * std::numbers::pi);
        if (reading.has_return()) {
          ++returns;
          hit.insert(column_of(reading));
        } else {
          EXPECT_TRUE(absent.insert(column_of(reading)).second) << "twice without return";
        }
      }
      EXPECT_EQ(hit.size() + absent.size(), kColumns);
      for (const std::size_t column : hit) {
        EXPECT_FALSE(absent.contains(column));
      }
    }
    EXPECT_EQ(returns, cloud.points.size());
  }
}

TEST(CloudScanlines, AnAbsentReadingHasTheTiltOfTheOneBeforeIt) {
  PointCloud cloud;
  cloud.has_ring = true;
  cloud.points = {{direction(1.0, 0.1), 0}, {direction(4.0, -0.2), 0}};
  const auto scanlines = scanlines_of_cloud(cloud, {}, kStep_rad, "c").value();
  ASSERT_EQ(scanlines.size(), 1U);
  EXPECT_EQ(scanlines[0].size(), kColumns);
  for (const Reading& reading : scanlines[0]) {
    const bool after_first = reading.pan_rad > 0.9999 && reading.pan_rad < 3.9999;
    EXPECT_NEAR(reading.tilt_rad, after_first ? 0.1 : -0.2, 1e-12) << reading.pan_rad;
  }
}

TEST(CloudScanlines, RefusesRingsThatWouldFillTheMemory) {
  PointCloud cloud;
  cloud.has_ring = true;
  for (std::uint32_t ring = 0; ring <= kRingMax; ++ring) {
    cloud.points.push_back({{1, 0, 0}, ring});
  }
  const auto scanlines = scanlines_of_cloud(cloud, {}, kStep_rad, "c.pcd");
  ASSERT_FALSE(scanlines);
  EXPECT_THAT(scanlines.error().message, HasSubstr("65536 scanlines of 701 columns"));
}

TEST(CloudScanlines, ACloudWithoutDirectionsHasNone) {
  EXPECT_TRUE(scanlines_of_cloud(PointCloud(), {}, kStep_rad, "c").value().empty());
}

}  // namespace
}  // namespace slamsensor::tools
