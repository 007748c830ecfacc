#include "core/config.hpp"
#include "tools/world/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

using core::kDegree;

World make(WorldConfig config) {
  config.rangefinder.noise_sigma_m = 0.0;
  config.rangefinder.resolution_m = 0.0;
  auto world = World::create(config);
  EXPECT_TRUE(world.has_value()) << world.error().message;
  return std::move(*world);
}

SweepConfig coarse() {
  SweepConfig sweep;
  sweep.pan_min_rad = -40.0 * kDegree;
  sweep.pan_max_rad = 40.0 * kDegree;
  sweep.pan_step_rad = 0.1 * kDegree;
  sweep.tilt_min_rad = -1.0 * kDegree;
  sweep.tilt_max_rad = 1.0 * kDegree;
  sweep.tilt_step_rad = 1.0 * kDegree;
  return sweep;
}

TEST(Sweep, PresetsHaveThePapersNumbers) {
  EXPECT_EQ(line_count(paper_sweep_1_2()), 51U);
  EXPECT_EQ(readings_per_line(paper_sweep_1_2()), 5000U);
  EXPECT_NEAR(scan_duration_s(paper_sweep_1_2()), 255.0, 0.01);
  EXPECT_NEAR(paper_sweep_1_2().pan_max_rad / kDegree, 128.57, 0.005);
  EXPECT_NEAR(paper_sweep_1_2().tilt_min_rad / kDegree, -18.0, 1e-9);
  EXPECT_NEAR(paper_sweep_1_2().tilt_max_rad / kDegree, 7.71, 0.005);
  EXPECT_EQ(line_count(paper_sweep_3_4()), 26U);
  EXPECT_EQ(line_count(paper_sweep_3_4()) * readings_per_line(paper_sweep_3_4()), 130'000U);
  EXPECT_NEAR(paper_sweep_3_4().tilt_min_rad / kDegree, -17.5, 0.02);
  EXPECT_NEAR(paper_sweep_3_4().tilt_max_rad / kDegree, 8.23, 0.005);
}

TEST(Sweep, LinesAlternateAndShareATilt) {
  const auto lines = scan(make({}), coarse(), {}, 0.0, 1);
  ASSERT_EQ(lines.size(), 3U);
  for (std::size_t line = 0; line < lines.size(); ++line) {
    ASSERT_EQ(lines[line].size(), 800U);
    EXPECT_NEAR(lines[line].front().tilt_rad, (static_cast<double>(line) - 1.0) * kDegree, 1e-12);
    EXPECT_EQ(lines[line].front().tilt_rad, lines[line].back().tilt_rad);
    const double first_deg = lines[line].front().pan_rad / kDegree;
    EXPECT_NEAR(first_deg, line % 2 == 0 ? 39.95 : -39.95, 1e-9);
    EXPECT_NEAR(lines[line].back().pan_rad / kDegree, -first_deg, 1e-9);
  }
  SweepConfig one_way = coarse();
  one_way.order = SweepOrder::OneWay;
  EXPECT_GT(scan(make({}), one_way, {}, 0.0, 1)[1].front().pan_rad, 0.0);
}

TEST(Sweep, ReadingsAreInTheFrameOfTheSensor) {
  WorldConfig config;
  config.stems = {{10.0, 20.0}};
  const core::Pose2 pose_W{10.0, 5.0, 80.0 * kDegree};  // the tree is 10 deg to the left
  double nearest_m = 1e9;
  double pan_rad = 0.0;
  const auto lines = scan(make(config), coarse(), pose_W, 0.0, 1);
  for (const core::Reading& reading : lines[1]) {
    if (reading.has_return() && reading.range_m < nearest_m) {
      nearest_m = reading.range_m;
      pan_rad = reading.pan_rad;
    }
  }
  EXPECT_NEAR(pan_rad, 10.0 * kDegree, 0.1 * kDegree);
  EXPECT_LT(nearest_m, 15.0);
  EXPECT_GT(nearest_m, 14.5);
}

TEST(Sweep, LevelledGroundIsSeenAtItsDepression) {
  const auto lines = scan(make({}), coarse(), {3.0, 4.0, 0.5}, 0.0, 1);
  for (const core::Reading& reading : lines[0]) {
    EXPECT_NEAR(reading.range_m, 1.5 / std::sin(1.0 * kDegree), 1e-6);
  }
  EXPECT_FALSE(lines[1].front().has_return());
  EXPECT_FALSE(lines[2].front().has_return());
}

TEST(Sweep, PitchLowersTheFront) {
  SweepConfig sweep = coarse();
  sweep.pitch_rad = 2.0 * kDegree;
  const auto lines = scan(make({}), sweep, {}, 0.0, 1);
  EXPECT_NEAR(lines[1][400].range_m, 1.5 / std::sin(2.0 * kDegree), 0.01);  // straight ahead
  sweep.pitch_rad = 0.0;
  sweep.roll_rad = 5.0 * kDegree;
  const auto rolled = scan(make({}), sweep, {}, 0.0, 1);
  EXPECT_FALSE(rolled[1].back().has_return());  // far left looks up
  EXPECT_TRUE(rolled[1].front().has_return());  // far right looks down
}

// A person crosses ahead while the line is swept against the walk: the reading that meets it is the one whose
// ray points at where the person is at that reading's time.
TEST(Sweep, MoverAppearsWhereItIsAtEachReadingsTime) {
  WorldConfig config;
  MoverConfig person;
  person.x1_m = person.x2_m = 10.0;
  person.y1_m = -8.0;
  person.y2_m = 8.0;
  person.speed_mps = 10.0;
  config.movers = {person};
  const World world = make(config);
  SweepConfig sweep = coarse();
  sweep.tilt_min_rad = sweep.tilt_max_rad = 0.0;
  const double start_s = 0.2;
  const auto lines = scan(world, sweep, {}, start_s, 1);
  int seen = 0;
  for (std::size_t i = 0; i < lines[0].size(); ++i) {
    const double y_m = place_at(person, start_s + 0.001 * static_cast<double>(i)).position_W.y();
    const double bearing_rad = std::atan2(y_m, 10.0);
    const double half_width_rad = std::asin(0.25 / std::hypot(10.0, y_m));
    const bool expected = std::abs(lines[0][i].pan_rad - bearing_rad) < half_width_rad;
    EXPECT_EQ(lines[0][i].has_return(), expected) << i;
    seen += expected ? 1 : 0;
  }
  EXPECT_GT(seen, 3);
  EXPECT_LT(seen, 29);  // standing still it would be seen by 28: it walks against the sweep
}

TEST(Sweep, EqualSeedsEqualScansOtherSeedsOtherNoise) {
  WorldConfig config;
  config.trees.density_per_ha = 60.0;
  const auto world = World::create(config);
  ASSERT_TRUE(world.has_value());
  const auto ranges = [&world](std::uint64_t seed) {
    std::vector<double> values;
    for (const auto& line : scan(*world, coarse(), {}, 0.0, seed)) {
      for (const core::Reading& reading : line) {
        values.push_back(reading.range_m);
      }
    }
    return values;
  };
  EXPECT_EQ(ranges(5), ranges(5));
  EXPECT_NE(ranges(5), ranges(6));
}

TEST(Sweep, RefusesStepsAndRangesThatMakeNoSweep) {
  SweepConfig sweep = coarse();
  sweep.pan_step_rad = 0.0;
  EXPECT_TRUE(find_problem(sweep).has_value());
  EXPECT_TRUE(scan(make({}), sweep, {}, 0.0, 1).empty());
  sweep = coarse();
  sweep.tilt_step_rad = 1e-9;
  EXPECT_TRUE(find_problem(sweep).has_value());
  sweep = coarse();
  sweep.readings_per_second = std::nan("");
  EXPECT_TRUE(find_problem(sweep).has_value());
  EXPECT_FALSE(find_problem(coarse()).has_value());
}

}  // namespace
}  // namespace slamsensor::tools
