#include "core/detection/landmark_detector.hpp"
#include "core/geometry/pose2.hpp"
#include "tests/unit/core/detection/detection_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace slamsensor::core {
namespace {

using detection_test::detect;
using detection_test::Detector;
using detection_test::random_scan;
using detection_test::Scan;
using detection_test::Scanline;

void expect_equal(const std::vector<ScanLandmark>& a, const std::vector<ScanLandmark>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].weight, b[i].weight) << i;
    EXPECT_EQ(a[i].position_L, b[i].position_L) << i;
  }
}

/// 500 columns of 0.72 deg, so that a whole turn is whole columns; all landmarks are kept.
DetectionConfig property_config(LandmarkPoint point) {
  DetectionConfig config;
  config.bearing_step_rad = 0.72 * kDegree;
  config.discard_share = 0.0;
  config.landmarks_max = 1000;
  config.point = point;
  return config;
}

class LandmarkDetectorProperty : public testing::TestWithParam<LandmarkPoint> {};

TEST_P(LandmarkDetectorProperty, TurningByWholeColumnsTurnsTheLandmarks) {
  const DetectionConfig config = property_config(GetParam());
  Detector detector(config);
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Scan scan = random_scan(config, 500, random);
    const auto before = detect(*detector, scan);
    ASSERT_GT(before.size(), 10U);
    const double turn_rad = static_cast<double>(random() % 500) * config.bearing_step_rad;
    for (Scanline& scanline : scan) {
      for (Reading& reading : scanline) {
        reading.pan_rad += seed % 2 == 0 ? turn_rad : turn_rad - 2.0 * std::numbers::pi;
      }
    }
    const auto after = detect(*detector, scan);
    ASSERT_EQ(after.size(), before.size());
    const Pose2 turn{0.0, 0.0, turn_rad};
    for (const ScanLandmark& landmark : before) {
      const Point2 turned = turn * landmark.position_L;
      EXPECT_TRUE(std::any_of(after.begin(), after.end(), [&](const ScanLandmark& other) {
        return other.weight == landmark.weight && (other.position_L - turned).norm() < 1e-8;
      })) << turned.transpose();
    }
  }
}

TEST_P(LandmarkDetectorProperty, OrderOfTheReadingsInAScanlineIsImmaterial) {
  const DetectionConfig config = property_config(GetParam());
  Detector detector(config);
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Scan scan = random_scan(config, 500, random);
    const auto forth = detect(*detector, scan);
    for (Scanline& scanline : scan) {
      std::reverse(scanline.begin(), scanline.end());
    }
    expect_equal(detect(*detector, scan), forth);
    for (Scanline& scanline : scan) {
      std::shuffle(scanline.begin(), scanline.end(), random);
    }
    expect_equal(detect(*detector, scan), forth);
  }
}

TEST_P(LandmarkDetectorProperty, SweepDirectionIsImmaterialWithEndsDiscarded) {
  DetectionConfig config = property_config(GetParam());
  config.discard_share = 0.03;
  Detector detector(config);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Scan scan = random_scan(config, 350, random);  // not all the way round
    const auto forth = detect(*detector, scan);
    for (std::size_t i = 0; i < scan.size(); i += 2) {
      std::reverse(scan[i].begin(), scan[i].end());
    }
    expect_equal(detect(*detector, scan), forth);
  }
}

TEST_P(LandmarkDetectorProperty, OrderOfTheScanlinesIsImmaterial) {
  const DetectionConfig config = property_config(GetParam());
  Detector detector(config);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Scan scan = random_scan(config, 500, random);
    const auto up = detect(*detector, scan);
    std::shuffle(scan.begin(), scan.end(), random);
    const auto shuffled = detect(*detector, scan);
    ASSERT_EQ(shuffled.size(), up.size());
    for (std::size_t i = 0; i < up.size(); ++i) {
      EXPECT_EQ(shuffled[i].weight, up[i].weight);
      EXPECT_LT((shuffled[i].position_L - up[i].position_L).norm(), 1e-9);  // sums in another order
    }
  }
}

TEST_P(LandmarkDetectorProperty, AScanDoesNotDependOnTheOneBefore) {
  const DetectionConfig config = property_config(GetParam());
  Capacities scarce;
  scarce.occupied_cells = 150;
  for (const Capacities& capacities : {Capacities{}, scarce}) {
    Detector used(config, capacities);
    for (unsigned seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(seed);
      std::mt19937_64 random(seed);
      const Scan scan = random_scan(config, 500, random);
      Detector fresh(config, capacities);
      expect_equal(detect(*used, scan), detect(*fresh, scan));
    }
  }
}

TEST_P(LandmarkDetectorProperty, ImpossibleReadingsChangeNothing) {
  const DetectionConfig config = property_config(GetParam());
  Detector detector(config);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<double> bad{kNan, kInfinity, -kInfinity};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Scan scan = random_scan(config, 500, random);
    const auto clean = detect(*detector, scan);
    for (Scanline& scanline : scan) {
      for (int i = 0; i < 50; ++i) {
        Reading reading{0.01 * static_cast<double>(random() % 600), 0.0, 0.3};
        double* const fields[]{&reading.pan_rad, &reading.tilt_rad, &reading.range_m};
        *fields[random() % 3] = bad[random() % bad.size()];
        scanline.insert(scanline.begin() + static_cast<std::ptrdiff_t>(random() % (scanline.size() + 1)),
                        reading);
      }
    }
    const std::uint64_t before = detector->readings_refused();
    expect_equal(detect(*detector, scan), clean);
    EXPECT_EQ(detector->readings_refused() - before, 50 * scan.size());
  }
}

TEST_P(LandmarkDetectorProperty, AnyBitPatternIsSurvived) {
  const DetectionConfig config = property_config(GetParam());
  Detector detector(config);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const auto any = [&] { return std::bit_cast<double>(static_cast<std::uint64_t>(random())); };
    const auto some = [&](double usual) { return random() % 3 == 0 ? any() : usual; };
    Scan scan(5, Scanline(2000));
    for (Scanline& scanline : scan) {
      for (Reading& reading : scanline) {
        const double pan_rad = 0.001 * static_cast<double>(random() % 6000);
        reading = {some(pan_rad), some(0.1), some(0.1 * static_cast<double>(random() % 3000))};
      }
    }
    for (const ScanLandmark& landmark : detect(*detector, scan)) {
      EXPECT_LE(landmark.position_L.norm(), config.range_max_m + config.range_step_m);  // false for NaN
      EXPECT_GE(landmark.weight, 1.0);
      EXPECT_LE(landmark.weight, 5.0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Points, LandmarkDetectorProperty,
                         testing::Values(LandmarkPoint::HullCentroid, LandmarkPoint::ReadingMean),
                         [](const auto& param_info) {
                           return param_info.param == LandmarkPoint::HullCentroid ? "HullCentroid"
                                                                                  : "ReadingMean";
                         });

}  // namespace
}  // namespace slamsensor::core
