#include "core/sweep/motion_detector.hpp"

#include "core/config.hpp"
#include "tests/unit/firmware/scan/carried_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace slamsensor::firmware {
namespace {

using core::LineMarks;
using core::Mark;
using core::MarkKind;
using core::MotionConfig;
using core::MotionDetector;
using core::MotionEvent;

using core::kDegree;
constexpr std::uint32_t kLines = 20;
constexpr double kTiltMin_rad = -6.0 * kDegree;
constexpr double kTiltStep_rad = 0.6 * kDegree;

/// The line at which `detector` saw the sensor move in a scan of `scene`; nothing when it did not.
std::optional<std::uint32_t> scan(MotionDetector& detector, CarriedScene& scene) {
  detector.begin_scan();
  for (std::uint32_t line = 0; line < kLines; ++line) {
    detector.add(scene.sweep(line, kTiltMin_rad + line * kTiltStep_rad));
    if (detector.has_moved()) {
      return line;
    }
  }
  return std::nullopt;
}

std::optional<std::uint32_t> scan(CarriedScene& scene) {
  MotionDetector detector({});
  return scan(detector, scene);
}

/// `from` until line `line` begins, then `to`.
std::function<Place(double)> jump(std::uint32_t line, const Place& to) {
  return [=](double time_s) { return time_s < line * CarriedScene::kLine_s - 0.2 ? Place{} : to; };
}

CarriedScene grove(std::uint64_t seed) {
  CarriedScene scene;
  scene.seed = seed;
  scene.scatter(60);
  return scene;
}

TEST(MotionDetector, AScanAtRestIsNone) {
  MotionDetector detector({});
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CarriedScene scene = grove(seed);
    EXPECT_EQ(scan(detector, scene), std::nullopt) << "seed " << seed;
  }
  EXPECT_GT(detector.count(MotionEvent::LinesJudged), 80U);
  EXPECT_EQ(detector.count(MotionEvent::LinesSuspect), 0U);
}

TEST(MotionDetector, APushIsSeenTwoLinesLaterAndMeasured) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CarriedScene scene = grove(seed);
    scene.path = jump(10, {0.3, -0.2, 0.0});
    MotionDetector detector({});
    EXPECT_EQ(scan(detector, scene), 11U) << "seed " << seed;
    EXPECT_EQ(detector.count(MotionEvent::ScansDisplaced), 1U);
    ASSERT_TRUE(detector.last_line().jump);
    EXPECT_NEAR(detector.last_line().jump->x_m, 0.3, 0.05) << "seed " << seed;
    EXPECT_NEAR(detector.last_line().jump->y_m, -0.2, 0.05);
    EXPECT_NEAR(detector.last_line().jump->turn_rad, 0.0, 0.005);
  }
}

TEST(MotionDetector, ATurnIsSeenAndASmallOneMeasured) {
  for (const double turn_deg : {-5.0, -2.0, 1.2}) {
    CarriedScene scene = grove(3);
    scene.path = jump(10, {0.0, 0.0, turn_deg * kDegree});
    MotionDetector detector({});
    const auto line = scan(detector, scene);
    ASSERT_TRUE(line) << turn_deg;
    EXPECT_LE(*line, 12U) << turn_deg;
    if (detector.count(MotionEvent::ScansDisplaced) > 0) {  // else nothing was seen again
      EXPECT_NEAR(detector.last_line().jump->turn_rad, turn_deg * kDegree, 0.003);
    } else {
      EXPECT_LT(turn_deg, -1.5);
    }
  }
}

TEST(MotionDetector, LiftedElsewhereAllHasChanged) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CarriedScene scene = grove(seed);
    scene.path = jump(10, {7.0, 5.0, 1.0});
    MotionDetector detector({});
    const auto line = scan(detector, scene);
    ASSERT_TRUE(line) << "seed " << seed;
    EXPECT_LE(*line, 13U) << "seed " << seed;
    EXPECT_EQ(detector.count(MotionEvent::ScansChanged), 1U);
  }
}

TEST(MotionDetector, ASlowCreepIsSeen) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CarriedScene scene = grove(seed);
    scene.path = [](double time_s) { return Place{0.02 * time_s, 0.0, 0.0}; };
    EXPECT_TRUE(scan(scene)) << "seed " << seed;
    scene.path = [](double time_s) { return Place{0.0, 0.0, 0.001 * time_s}; };
    EXPECT_TRUE(scan(scene)) << "seed " << seed;
  }
}

TEST(MotionDetector, WhoeverWalksThroughMovesNothing) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CarriedScene scene = grove(seed);
    const std::size_t standing = scene.columns.size();
    scene.scatter(standing + 15);  // people: a quarter as many as what stands
    scene.stir = [=](double, std::vector<Column>& columns) {
      for (std::size_t i = standing; i < columns.size(); ++i) {
        columns[i].x_m += (i % 2 == 0 ? 0.3 : -0.5);
        columns[i].y_m += 0.4;
      }
    };
    EXPECT_EQ(scan(scene), std::nullopt) << "seed " << seed;
  }
}

TEST(MotionDetector, NeitherALeaningMountNorALatencyIsMotion) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CarriedScene scene = grove(seed);
    scene.lean_rad = 2.0 * kDegree;
    EXPECT_EQ(scan(scene), std::nullopt) << "seed " << seed;
    scene.lean_rad = 0.0;
    scene.late_s = 0.02;
    EXPECT_EQ(scan(scene), std::nullopt) << "seed " << seed;
  }
}

TEST(MotionDetector, FineVibrationIsLetPass) {
  CarriedScene scene = grove(5);
  scene.path = [](double time_s) {
    return Place{0.01 * std::sin(31.0 * time_s), 0.01 * std::cos(17.0 * time_s),
                 0.002 * std::sin(23.0 * time_s)};
  };
  EXPECT_EQ(scan(scene), std::nullopt);
}

TEST(MotionDetector, WhereNothingStandsNothingIsSaid) {
  CarriedScene scene;
  scene.path = [](double time_s) { return Place{0.5 * time_s, 0.0, 0.0}; };
  MotionDetector detector({});
  EXPECT_EQ(scan(detector, scene), std::nullopt);
  EXPECT_EQ(detector.count(MotionEvent::LinesJudged), 0U);
  EXPECT_EQ(detector.count(MotionEvent::LinesNotJudged), kLines);
}

TEST(MotionDetector, SwitchedOffItLooksAtNothing) {
  MotionConfig config;
  config.enabled = false;
  MotionDetector detector(config);
  CarriedScene scene = grove(1);
  scene.path = jump(10, {0.5, 0.0, 0.0});
  EXPECT_EQ(scan(detector, scene), std::nullopt);
  EXPECT_EQ(detector.count(MotionEvent::LinesNotJudged), 0U);
}

TEST(MotionDetector, ANewScanStartsAfresh) {
  MotionDetector detector({});
  CarriedScene scene = grove(2);
  scene.path = jump(8, {0.5, 0.0, 0.0});
  EXPECT_TRUE(scan(detector, scene));
  scene.path = [](double) { return Place{0.5, 0.0, 0.0}; };
  EXPECT_EQ(scan(detector, scene), std::nullopt) << "at rest where it was put";
}

TEST(LineMarks, APostIsFoundWhereItStands) {
  CarriedScene scene;
  scene.columns = {{10.0, 0.0, 0.25, 5.0}, {0.0, 20.0, 0.3, 5.0}};
  scene.noise_m = 0.0;
  LineMarks marks;
  for (const std::uint32_t line : {0U, 1U}) {
    marks.build(scene.sweep(line, 2.0 * kDegree), 100.0);
    ASSERT_EQ(marks.marks().size(), 2U);
    EXPECT_EQ(marks.marks()[0].kind, MarkKind::Post);
    EXPECT_NEAR(marks.marks()[0].bearing_rad, 0.0, 0.001);
    EXPECT_NEAR(marks.marks()[0].range_m, 9.8, 0.05);
    EXPECT_NEAR(marks.marks()[1].bearing_rad, 0.5 * std::numbers::pi, 0.001);
    EXPECT_NEAR(marks.marks()[1].range_m, 19.8, 0.08);
  }
}

TEST(LineMarks, AWallIsFacesWithTheirSlope) {
  CarriedScene scene;
  scene.noise_m = 0.0;
  scene.columns = {{1010.0, 0.0, 1000.0, 50.0}};  // as good as flat, 10 m ahead
  LineMarks marks;
  marks.build(scene.sweep(0, 1.0 * kDegree), 60.0);
  ASSERT_GT(marks.marks().size(), 30U);
  for (const Mark& mark : marks.marks()) {
    ASSERT_EQ(mark.kind, MarkKind::Face);
    if (std::abs(mark.bearing_rad) < 0.8) {
      EXPECT_NEAR(mark.range_m, 10.0 / std::cos(mark.bearing_rad), 0.1);
      EXPECT_NEAR(mark.slope_mprad, 10.0 * std::tan(mark.bearing_rad) / std::cos(mark.bearing_rad), 0.5);
    }
  }
}

}  // namespace
}  // namespace slamsensor::firmware
