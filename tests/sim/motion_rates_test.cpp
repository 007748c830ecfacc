// How often a scan at rest is taken for a moved one, and how often a moved one is found out, in many worlds.
// Scanlines come straight from the world; the sensor moves between and within them. SLAMSENSOR_MOTION_SCANS
// says how many scans of each kind in each world (default 6; 100 for the table).

#include "core/config.hpp"
#include "core/sweep/motion_detector.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/random.hpp"
#include "tools/world/simulate.hpp"
#include "tools/world/world_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

using core::kDegree;

std::uint64_t scan_count() {
  const char* const count = std::getenv("SLAMSENSOR_MOTION_SCANS");
  return count != nullptr ? std::strtoull(count, nullptr, 10) : 6;
}

/// How a head sweeps: back and forth from the lowest tilt up.
struct Head {
  std::string name;
  double rate_hz;
  double speed_radps;
  double tilt_min_rad;
  double tilt_step_rad;
  std::uint32_t lines;
  double change_s;

  static constexpr double kPanMax_rad = 2500.0 * firmware::kPaperStep_rad;

  [[nodiscard]] double line_s() const { return 2.0 * kPanMax_rad / speed_radps + change_s; }
};

Head paper_head() {
  const double step = firmware::kPaperStep_rad;
  return {"paper", 500.0, 1000.0 * step, -350.0 * step, 10.0 * step, 51, 0.5};
}

Head fast_head() {
  const double step = firmware::kPaperStep_rad;
  return {"fast", 5000.0, 300.0 * kDegree, -350.0 * step, 30.0 * step, 17, 0.05};
}

Head short_head() {
  const double step = firmware::kPaperStep_rad;
  return {"short", 1000.0, 300.0 * kDegree, -10.0 * step, 20.0 * step, 4, 0.05};
}

/// A world by its name, for a seed.
WorldConfig world_config(const std::string& name, std::uint64_t seed) {
  const auto folder = tests::source_tree() / "config/worlds";
  if (std::filesystem::exists(folder / (name + ".toml"))) {
    auto config = load_world(folder / (name + ".toml"));
    EXPECT_TRUE(config) << config.error().message;
    config->seed = seed;
    config->stands.clear();
    return *config;
  }
  WorldConfig config;
  config.seed = seed;
  if (name == "forest") {
    config.area = {-80.0, 80.0, -80.0, 80.0, 0.3};
    config.trees.density_per_ha = 500.0;
    config.trees.spacing_m = 1.5;
    config.bushes.density_per_ha = 150.0;
    config.rocks.density_per_ha = 40.0;
    config.ground.amplitude_m = 1.0;
    config.people.count = 4;
  } else if (name == "yard") {
    config.area = {-24.0, 24.0, -17.0, 11.0, 0.5};
    config.walls = {{-25, -18, 25, -18, 4}, {25, -18, 25, 12, 4}, {25, 12, -25, 12, 4},
                    {-25, 12, -25, -18, 4}, {10, -5, 18, -5, 3},  {18, -5, 18, 0, 3}};
    config.people.count = 8;
    config.people.path_m = {5.0, 15.0};
    config.posts.density_per_ha = 20.0;
  } else if (name == "bank") {
    config.area = {-100.0, 100.0, -100.0, 100.0, 0.6};
    config.ground.slope_x = 0.25;
    config.ground.amplitude_m = 3.0;
    config.ground.wavelength_m = {15.0, 60.0};
    config.trees.density_per_ha = 25.0;
    config.bushes.density_per_ha = 30.0;
  } else {  // field
    config.area = {-150.0, 150.0, -150.0, 150.0, 1.0};
    config.trees.density_per_ha = 1.5;
    config.bushes.density_per_ha = 3.0;
    config.posts.density_per_ha = 2.0;
    config.ground.amplitude_m = 0.6;
  }
  return config;
}

/// Whether a sensor in that world sees enough that stands wherever it is.
bool stands_enough(const std::string& world) {
  return world == "bush" || world == "park" || world == "plantation" || world == "forest";
}

/// Where the sensor is, `time_s` after the scan began, beside where it was.
using Motion = std::function<core::Pose2(double time_s)>;

/// One scan of a sensor that stands at `stand_W` and moves by `motion`; whether the detector saw it move.
class MovedScan {
 public:
  MovedScan(const World& world, const Head& head) : world_(world), head_(head) {}

  bool is_seen(const core::Pose2& stand_W, const Motion& motion, std::uint64_t seed) {
    Random rng(seed);
    mount_.roll_rad = 0.01 * draw_normal(rng);
    mount_.pitch_rad = 0.01 * draw_normal(rng);
    const double begin_s = draw_uniform(rng, 0.0, 10'000.0);
    core::MotionDetector detector({});
    detector.begin_scan();
    for (std::uint32_t line = 0; line < head_.lines && !detector.has_moved(); ++line) {
      detector.add(sweep(line, stand_W, motion, begin_s, rng));
    }
    detector.end_scan();
    return detector.has_moved();
  }

 private:
  const core::Scanline& sweep(std::uint32_t number, const core::Pose2& stand_W, const Motion& motion,
                              double begin_s, Random& rng) {
    const bool leftwards = number % 2 == 0;
    const double tilt_rad = head_.tilt_min_rad + number * head_.tilt_step_rad;
    const double readings = 2.0 * Head::kPanMax_rad / head_.speed_radps * head_.rate_hz;
    readings_.clear();
    for (double i = 0.5; i < readings; i += 1.0) {
      const double way_rad = head_.speed_radps * i / head_.rate_hz;
      const double pan_rad = leftwards ? way_rad - Head::kPanMax_rad : Head::kPanMax_rad - way_rad;
      const double time_s = number * head_.line_s() + i / head_.rate_hz;
      const core::Pose2 off = motion(time_s);
      const core::Pose2 pose_W{stand_W.x_m + off.x_m, stand_W.y_m + off.y_m,
                               stand_W.heading_rad + off.heading_rad};
      const SensorPlace place = sensor_place(world_, mount_, pose_W);
      const Eigen::Vector3d direction_W =
          place.R_W_L * direction_L(pan_rad, std::cos(tilt_rad), std::sin(tilt_rad));
      readings_.push_back(
          {pan_rad, tilt_rad, world_.cast(place.position_W, direction_W, begin_s + time_s, rng).range_m});
    }
    line_.readings = readings_;
    line_.tilt_rad = tilt_rad;
    line_.direction = leftwards ? core::SweepDirection::Leftwards : core::SweepDirection::Rightwards;
    line_.line = number;
    return line_;
  }

  const World& world_;
  Head head_;
  SweepConfig mount_;
  std::vector<core::Reading> readings_;
  core::Scanline line_;
};

struct Case {
  std::string name;
  std::function<Motion(double begin_s, double course_rad)> motion;
  bool must_be_seen;          ///< in a third of the scans at least where enough stands ...
  bool in_few_lines = false;  ///< ... also by a scan of few lines
};

Motion jump(double begin_s, double course_rad, double distance_m, double turn_rad) {
  const core::Pose2 off{distance_m * std::cos(course_rad), distance_m * std::sin(course_rad), turn_rad};
  return [=](double time_s) { return time_s < begin_s ? core::Pose2{} : off; };
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const double distance_m : {0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 10.0}) {
    all.push_back(
        {std::to_string(distance_m).substr(0, 4) + " m",
         [=](double begin_s, double course_rad) { return jump(begin_s, course_rad, distance_m, 0.0); },
         distance_m >= 0.5, distance_m >= 2.0});
  }
  for (const double turn_deg : {0.5, 1.0, 2.0, 5.0, 20.0}) {
    all.push_back({std::to_string(turn_deg).substr(0, 4) + " deg",
                   [=](double begin_s, double) { return jump(begin_s, 0.0, 0.0, turn_deg * kDegree); },
                   turn_deg >= 2.0, turn_deg >= 5.0});
  }
  all.push_back({"creep 0.02 m/s",
                 [](double, double course_rad) -> Motion {
                   return [=](double time_s) {
                     return core::Pose2{0.02 * time_s * std::cos(course_rad),
                                        0.02 * time_s * std::sin(course_rad), 0.0};
                   };
                 },
                 false});
  all.push_back({"walks 0.5 m/s in a circle",
                 [](double, double) -> Motion {
                   return [](double time_s) {
                     const double turn_rad = 0.125 * time_s;
                     return core::Pose2{4.0 * std::sin(turn_rad), 4.0 - 4.0 * std::cos(turn_rad), turn_rad};
                   };
                 },
                 false});
  return all;
}

class MotionRates : public testing::TestWithParam<std::string> {
 protected:
  /// How many of the scans are taken for moved ones, those of one case in one world.
  static int seen(const Head& head, const Case* moved, double first_share, std::uint64_t first_seed) {
    int count = 0;
    for (std::uint64_t seed = first_seed; seed < first_seed + scan_count(); ++seed) {
      const auto world = World::create(world_config(GetParam(), seed));
      EXPECT_TRUE(world) << world.error().message;
      DriveConfig drive;
      drive.stands = 1;
      drive.margin_m = 3.0;
      const auto stands = make_drive(*world, drive, seed);
      EXPECT_TRUE(stands) << stands.error().message;
      Random rng(mix_seed(seed, 5));
      const double line = std::floor(head.lines * draw_uniform(rng, first_share, 0.9));
      const double course_rad = draw_uniform(rng, -std::numbers::pi, std::numbers::pi);
      const Motion motion = moved != nullptr ? moved->motion(line * head.line_s() - 0.02, course_rad)
                                             : [](double) { return core::Pose2{}; };
      const bool is_seen = MovedScan(*world, head).is_seen(stands->front().pose, motion, mix_seed(seed, 6));
      count += is_seen ? 1 : 0;
      if (is_seen && moved == nullptr) {
        std::printf("  at rest, taken for moved: %s, seed %llu\n", GetParam().c_str(),
                    static_cast<unsigned long long>(seed));
      }
    }
    return count;
  }
};

TEST_P(MotionRates, AtRestAndMoved) {
  const int scans = static_cast<int>(scan_count());
  for (const Head& head : {paper_head(), fast_head(), short_head()}) {
    const int at_rest = seen(head, nullptr, 0.2, 7000);
    std::printf("%s, %s head: at rest %d of %d", GetParam().c_str(), head.name.c_str(), at_rest, scans);
    EXPECT_LE(at_rest, scans / 50) << head.name << ", seeds from 7000";
    for (const Case& moved : cases()) {
      const int found = seen(head, &moved, 0.7, 8000);
      std::printf("; %s %d", moved.name.c_str(), found);
      const bool must_be_seen =
          (moved.must_be_seen && head.name == "paper") || (moved.in_few_lines && head.name == "short");
      if (must_be_seen && stands_enough(GetParam())) {
        EXPECT_GE(found * 3, scans) << head.name << ", " << moved.name << ", seeds from 8000";
      }
    }
    std::printf("\n");
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, MotionRates,
                         testing::Values("bush", "park", "plantation", "forest", "yard", "bank", "field"));

}  // namespace
}  // namespace slamsensor::tools
