#include "core/sweep/motion_detector.hpp"

#include "core/config.hpp"
#include "core/sweep/swept_line.hpp"
#include "tests/support/fake_head.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

namespace slamsensor::firmware {
namespace {

using core::Scanline;
using core::SweepDirection;

/// Where a sensor stands and looks.
struct Place {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
};

/// An upright cylinder on level ground.
struct Column {
  double x_m = 0.0;
  double y_m = 0.0;
  double radius_m = 0.2;
  double height_m = 6.0;
};

/// Columns on level ground, 1.5 m under the sensor, seen line by line by a sensor that may move.
class CarriedScene {
 public:
  std::vector<Column> columns;
  std::function<Place(double time_s)> path = [](double) { return Place{}; };
  std::function<void(double time_s, std::vector<Column>&)> stir;  ///< moves columns; once for each line
  double noise_m = 0.1;
  double late_s = 0.0;    ///< by which readings are taken for later than they are
  double lean_rad = 0.0;  ///< of the mount, to the left
  std::uint64_t seed = 1;

  static constexpr double kSpeed_radps = 0.9;
  static constexpr double kPanMax_rad = 2.2;
  static constexpr double kLine_s = 2.0 * kPanMax_rad / kSpeed_radps + 0.5;
  static constexpr double kPitch_rad = 0.0018;

  /// Columns at random, 3 m to 40 m around.
  void scatter(std::size_t count) {
    std::mt19937_64 rng(seed * 7919);
    while (columns.size() < count) {
      const double bearing_rad = 2.0 * std::numbers::pi * tests::draw(rng);
      const double range_m = 3.0 + 37.0 * std::sqrt(tests::draw(rng));
      columns.push_back({range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad),
                         0.1 + 0.3 * tests::draw(rng), 2.0 + 6.0 * tests::draw(rng)});
    }
  }

  /// The scanline `number`, at `tilt_rad`; valid until the next.
  const Scanline& sweep(std::uint32_t number, double tilt_rad) {
    if (number == 0) {
      rng_.seed(seed);
    }
    const bool leftwards = number % 2 == 0;
    const double begin_s = number * kLine_s;
    if (stir) {
      stir(begin_s, columns);
    }
    readings_.clear();
    for (double way_rad = 0.0; way_rad < 2.0 * kPanMax_rad; way_rad += kPitch_rad) {
      const double pan_rad = leftwards ? way_rad - kPanMax_rad : kPanMax_rad - way_rad;
      const double late_rad = (leftwards ? 1.0 : -1.0) * late_s * kSpeed_radps;
      const Place place = path(begin_s + way_rad / kSpeed_radps);
      readings_.push_back({pan_rad + late_rad, tilt_rad, range_m(place, pan_rad, tilt_rad)});
    }
    stamps_.assign(readings_.size(), hal::from_seconds(begin_s));
    line_.readings = readings_;
    line_.stamps = stamps_;
    line_.tilt_rad = tilt_rad;
    line_.direction = leftwards ? SweepDirection::Leftwards : SweepDirection::Rightwards;
    line_.line = number;
    return line_;
  }

 private:
  double range_m(const Place& place, double pan_rad, double tilt_rad) {
    const double level_rad = tilt_rad + lean_rad * std::sin(pan_rad);
    const double bearing_rad =
        pan_rad + place.heading_rad - lean_rad * std::cos(pan_rad) * std::tan(tilt_rad);
    const double c = std::cos(bearing_rad);
    const double s = std::sin(bearing_rad);
    double nearest_m = level_rad < 0.0 ? -1.5 / std::tan(level_rad) : 1e9;
    for (const Column& column : columns) {
      const double along_m = (column.x_m - place.x_m) * c + (column.y_m - place.y_m) * s;
      const double aside_m = (column.y_m - place.y_m) * c - (column.x_m - place.x_m) * s;
      const double deep_m2 = column.radius_m * column.radius_m - aside_m * aside_m;
      if (along_m > 0.0 && deep_m2 > 0.0) {
        const double hit_m = along_m - std::sqrt(deep_m2);
        const double above_m = 1.5 + hit_m * std::tan(level_rad);
        nearest_m = above_m < column.height_m ? std::min(nearest_m, hit_m) : nearest_m;
      }
    }
    if (nearest_m > 200.0) {
      return core::Reading::kNoReturn;
    }
    const double off_m = noise_m * (tests::draw(rng_) + tests::draw(rng_) + tests::draw(rng_) - 1.5) * 2.0;
    return std::max(0.1, nearest_m / std::cos(level_rad) + off_m);
  }

  std::mt19937_64 rng_;
  std::vector<core::Reading> readings_;
  std::vector<hal::Stamp> stamps_;
  Scanline line_;
};

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

// Nothing stands for long in a scan of four lines: a sensor that was carried on in it had a fix, and brought
// what it saw at two places into the map as one.
TEST(MotionDetector, AScanOfFewLinesIsJudgedAtItsEnd) {
  constexpr std::uint32_t kFew = 4;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const std::uint32_t moved_at : {kFew, 1U, 2U, 3U}) {  // kFew: at rest
      for (const Place& to : {Place{5.0, 0.0, 0.0}, Place{0.0, 0.0, 10.0 * kDegree}}) {
        CarriedScene scene = grove(seed);
        scene.path = jump(moved_at, to);
        MotionDetector detector({});
        detector.begin_scan();
        for (std::uint32_t line = 0; line < kFew; ++line) {
          detector.add(scene.sweep(line, (line - 1.0) * kTiltStep_rad));  // about the horizon
        }
        detector.end_scan();
        EXPECT_EQ(detector.has_moved(), moved_at < kFew)
            << "seed " << seed << ", line " << moved_at << ", " << to.x_m << " m";
      }
    }
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
