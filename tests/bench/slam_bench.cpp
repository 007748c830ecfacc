// The whole step (DESIGN 2.7, 7): core::Slam::process while a map grows to about 1,000 landmarks, with what
// it asks of the heap and of the kernel, and the memory plan.
#include "core/config.hpp"
#include "core/detection/landmark_detector.hpp"
#include "core/slam.hpp"
#include "tests/bench/heap_watch.hpp"
#include "tests/bench/matching_task.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <sys/mman.h>
#include <vector>

namespace slamsensor::bench {
namespace {

constexpr std::uint64_t kSeed = 41;
constexpr double kMebibyte = 1024.0 * 1024.0;

/// A spiral outwards from the middle of a forest, so that each turn sees trees of the turn before.
struct Drive {
  std::uint32_t trees = 3'000;
  std::uint32_t map_goal = 1'000;  ///< landmarks in the map at which the drive ends
  std::size_t scans_max = 400;
  double step_m = 8.0;  ///< between scans
  double gap_m = 12.0;  ///< between the turns of the spiral
};

struct SeenScan {
  std::vector<core::ScanLandmark> landmarks;
  core::Pose2 truth_W;
};

std::vector<SeenScan> scans_of(const Drive& drive) {
  tests::Draw draw(kSeed);
  const tests::Forest forest = tests::make_forest(drive.trees, draw);
  const Surroundings surroundings(forest);
  const tests::ScanModel model{20, 0.2, 1, 0.1};
  std::vector<SeenScan> scans;
  double turned_rad = 0.0;
  while (scans.size() < drive.scans_max) {
    const double radius_m = drive.gap_m * turned_rad / (2.0 * std::numbers::pi);
    const core::Pose2 pose_W{radius_m * std::cos(turned_rad), radius_m * std::sin(turned_rad),
                             draw.uniform(-std::numbers::pi, std::numbers::pi)};
    const tests::Forest about = surroundings.about(pose_W.translation(), model.nearest);
    scans.push_back({tests::as_landmarks(tests::scan_forest(about, pose_W, model, draw)), pose_W});
    turned_rad += drive.step_m / std::max(drive.step_m, radius_m);
  }
  return scans;
}

/// As the daemon does before its first scan: memory locked, the stack touched.
bool lock_memory() noexcept {
  std::array<volatile char, 512 * 1024> stack;
  for (std::size_t i = 0; i < stack.size(); i += 1024) {
    stack[i] = 0;
  }
  return mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
}

void measure_steps(Row row, const Drive& drive, const core::Config& config) {
  if (!heap_watch_works()) {
    std::abort();  // a count of 0 would mean nothing
  }
  const std::vector<SeenScan> scans = scans_of(drive);
  tests::InArena<core::Slam> slam(config);
  const bool locked = lock_memory();
  const core::Pose2 T_map_W = scans[0].truth_W.inverse();  // the first scan defines the map's frame
  Times times(scans.size());
  Times first_times(scans.size());  // up to a tenth of the goal
  Times last_times(scans.size());   // from nine tenths of it on
  std::uint64_t allocations = 0;
  std::uint64_t faults = 0;
  std::size_t fixes = 0;
  std::size_t wrong = 0;
  double worst_m = 0.0;
  std::uint32_t map_landmarks = 0;
  for (std::size_t s = 0; s < scans.size() && map_landmarks < drive.map_goal; ++s) {
    const HeapWatch watch;
    const std::uint64_t faults_before = page_faults_now();
    core::Fix fix;
    const double ms = cpu_of_ms([&] { fix = slam->process(scans[s].landmarks, {}, {}, {}); });
    const std::uint64_t faults_after = page_faults_now();
    if (s > 0) {
      times.add(ms);
      if (map_landmarks < drive.map_goal / 10) {
        first_times.add(ms);
      } else if (map_landmarks >= drive.map_goal / 10 * 9) {
        last_times.add(ms);
      }
      allocations += watch.use().allocations;
      faults += faults_after - faults_before;
    }
    if (fix.status == core::FixStatus::Fix) {
      const core::Pose2 truth = T_map_W * scans[s].truth_W;
      ++fixes;
      wrong += tests::is_right(fix.pose_W, truth) ? 0 : 1;
      worst_m = std::max(worst_m, (fix.pose_W.translation() - truth.translation()).norm());
    }
    map_landmarks = fix.landmarks_in_map;
  }
  row.number("scans", static_cast<double>(times.count() + 1), 0)
      .number("fixes", static_cast<double>(fixes), 0)
      .number("beyond 1 m or 2 deg", static_cast<double>(wrong), 0)
      .number("worst error m", worst_m, 2)
      .number("landmarks in map", map_landmarks, 0)
      .times(times)
      .number("first tenth, median ms", first_times.quantile_ms(0.5), 3)
      .number("last tenth, median ms", last_times.quantile_ms(0.5), 3)
      .number("first tenth, p99 ms", first_times.quantile_ms(0.99), 3)
      .number("last tenth, p99 ms", last_times.quantile_ms(0.99), 3)
      .number("allocations", static_cast<double>(allocations), 0)
      .number("page faults", static_cast<double>(faults), 0)
      .text("memory locked", locked ? "yes" : "not permitted")
      .finish(times.mean_ms());
}

/// A map of `trees` landmarks, each seen ten times, and scans of 60 landmarks all over it. The shots of a
/// scan are those of three scanlines past the same trees: what the detection makes of them is not used, so
/// that all sizes have the same landmarks.
struct Steady {
  static constexpr std::uint32_t kNearest = 80;
  static constexpr std::size_t kScans = 300;
  static constexpr std::size_t kShots = 7'200;
  static constexpr double kTreeRadius_m = 0.2;

  explicit Steady(std::uint32_t trees) {
    tests::Draw draw(kSeed);
    const tests::Forest forest = tests::make_forest(trees, draw);
    positions_W = forest.trees_W;
    for (std::uint32_t id = 0; id < trees; ++id) {
      landmarks.push_back(
          {.id = id, .xi = 0, .sightings = 10, .chances = 12, .first_scan = 0, .last_scan = 0});
    }
    const Surroundings surroundings(forest);
    const tests::ScanModel model{kNearest, 0.3, 4, 0.1};
    for (std::size_t i = 0; i < kScans; ++i) {
      const core::Pose2 pose_W = tests::pose_in(forest, draw);
      const auto seen =
          tests::scan_forest(surroundings.about(pose_W.translation(), kNearest), pose_W, model, draw);
      scans.push_back({tests::as_landmarks(seen), pose_W});
      shots.push_back(shots_at(seen));
    }
  }

  [[nodiscard]] core::MapState state() const {
    core::MapState state;
    state.landmarks = landmarks;
    state.positions_W = positions_W;
    state.next_id = static_cast<std::uint32_t>(landmarks.size());
    state.scans = 1;
    return state;
  }

  static std::vector<core::Reading> shots_at(const std::vector<core::Point2>& trees_L) {
    std::vector<core::Reading> readings(kShots);
    const double step_rad = 2.0 * std::numbers::pi / static_cast<double>(kShots);
    for (std::size_t i = 0; i < kShots; ++i) {
      readings[i] = {step_rad * static_cast<double>(i) - std::numbers::pi, 0.0, core::Reading::kNoReturn};
    }
    for (const core::Point2& tree : trees_L) {
      const double range_m = tree.norm();
      const double half_rad = kTreeRadius_m / range_m;
      const double bearing_rad = std::atan2(tree.y(), tree.x()) + std::numbers::pi;
      for (double turn_rad = -half_rad; turn_rad <= half_rad; turn_rad += step_rad) {
        const double turned = (bearing_rad + turn_rad) / step_rad + static_cast<double>(kShots);
        core::Reading& reading = readings[static_cast<std::size_t>(turned) % kShots];
        reading.range_m = reading.has_return() ? std::min(reading.range_m, range_m) : range_m;
      }
    }
    return readings;
  }

  std::vector<core::MapLandmark> landmarks;
  std::vector<core::Point2> positions_W;
  std::vector<SeenScan> scans;
  std::vector<std::vector<core::Reading>> shots;
};

/// Times of scans in a map that holds all that they show (tests/bench/profile says where they go).
void measure_steady(Row row, std::uint32_t trees, core::Config config) {
  config.capacities.scan_landmarks = core::kScanLandmarksMax;
  const Steady steady(trees);
  tests::InArena<core::Slam> slam(config);
  tests::InArena<core::LandmarkDetector> detector(config.detection);
  if (!slam->restore(steady.state()).ok()) {
    std::abort();
  }
  Times times(steady.scans.size());
  Times detection_times(steady.scans.size());
  std::size_t fixes = 0;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < steady.scans.size(); ++i) {
    detection_times.add(cpu_of_ms([&] {
      for (int line = 0; line < 3; ++line) {
        detector->add_scanline(steady.shots[i]);
      }
      benchmark::DoNotOptimize(detector->finish());
    }));
    core::Fix fix;
    times.add(cpu_of_ms([&] { fix = slam->process(steady.scans[i].landmarks, {}, {}, {}); }));
    const bool is_fix = fix.status == core::FixStatus::Fix;
    fixes += is_fix ? 1 : 0;
    wrong += is_fix && !tests::is_right(fix.pose_W, steady.scans[i].truth_W) ? 1 : 0;
  }
  row.number("scans", static_cast<double>(times.count()), 0)
      .number("fixes", static_cast<double>(fixes), 0)
      .number("beyond 1 m or 2 deg", static_cast<double>(wrong), 0)
      .number("detection ms", detection_times.quantile_ms(0.5), 3)
      .times(times)
      .finish(times.mean_ms());
}

void measure_plan(Row row, const core::Config& config) {
  std::size_t bytes = 0;
  const core::Arena::Plan plan = core::plan_memory(config, bytes);
  const auto largest = std::max_element(plan.begin(), plan.end(),
                                        [](const auto& a, const auto& b) { return a.bytes < b.bytes; });
  row.number("bytes", static_cast<double>(bytes), 0)
      .number("MiB", static_cast<double>(bytes) / kMebibyte, 1)
      .text("largest entry", largest->name)
      .number("its MiB", static_cast<double>(largest->bytes) / kMebibyte, 1)
      .finish(0.0);
}

void add_plan(Report& report, const std::string& name, const core::Config& config) {
  add_benchmark("slam/memory plan/" + name,
                [=, &report](benchmark::State& state) { measure_plan(Row(state, report, name), config); });
}

core::Config config_for(std::uint32_t landmarks, std::uint32_t hypotheses) {
  core::Config config;
  config.capacities.map_landmarks = landmarks;
  config.capacities.map_edges = 12 * landmarks;
  config.mapping.hypotheses_max = hypotheses;
  return config;
}

}  // namespace
}  // namespace slamsensor::bench

int main(int argc, char** argv) {
  using namespace slamsensor::bench;
  Report steps(
      "Slam::process on a simulated drive, from an empty map; the first scan is not counted (aim: 0 "
      "allocations, 0 page faults)");
  add_benchmark("slam/process", [&](benchmark::State& state) {
    measure_steps(Row(state, steps, "random forest, default config"), Drive{}, {});
  });
  add_benchmark("slam/drive to 20,000 landmarks", [&](benchmark::State& state) {
    slamsensor::core::Config config = config_for(24'000, 3);
    config.capacities.sightings = 200'000;
    measure_steps(Row(state, steps, "to 20,000 landmarks"), Drive{40'000, 20'000, 12'000, 12.0, 20.0},
                  config);
  });
  steps.add_note(
      "Errors are in the frame of the first scan: the drift of the map over the drive is in them.");
  Report steady(
      "Scans of 60 landmarks in a map that holds them (tests/bench/profile: where their time goes)");
  for (const std::uint32_t trees : {1'000U, 10'000U, 100'000U}) {
    add_benchmark("slam/steady/n=" + std::to_string(trees), [=, &steady](benchmark::State& state) {
      measure_steady(Row(state, steady, std::to_string(trees) + " landmarks"), trees,
                     config_for(trees + 5'000, 3));
    });
  }
  Report plan("Memory plan of core::Slam, taken once at the start (target: the whole daemon in 64 MiB)");
  add_plan(plan, "default config", {});
  add_plan(plan, "1,000 landmarks x 3 hypotheses", config_for(1000, 3));
  add_plan(plan, "10,000 landmarks x 3 hypotheses", config_for(10'000, 3));
  add_plan(plan, "100,000 landmarks x 3 hypotheses", config_for(100'000, 3));
  add_plan(plan, "1,000,000 landmarks x 3 hypotheses", config_for(1'000'000, 3));
  const int exit_code = run(argc, argv, steps);
  steady.print();
  plan.print();
  return exit_code;
}
