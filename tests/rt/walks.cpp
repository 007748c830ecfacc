#include "tests/rt/walks.hpp"

#include "tests/support/forest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

namespace slamsensor::tests {
namespace {

using core::Fix;
using core::FixReason;
using core::FixStatus;
using core::SearchMethod;
using core::Slam;

constexpr std::uint64_t kSeed = 20;  ///< each walk adds its own number

std::int64_t count(const std::vector<core::Fix>& fixes, core::FixStatus status) {
  return std::count_if(fixes.begin(), fixes.end(),
                       [&](const core::Fix& fix) { return fix.status == status; });
}

std::int64_t count(const std::vector<core::Fix>& fixes, core::FixReason reason) {
  return std::count_if(fixes.begin(), fixes.end(),
                       [&](const core::Fix& fix) { return fix.reason == reason; });
}

/// Capacities of a small world, and no more.
core::Config small_config(core::SearchMethod search = core::SearchMethod::Fast) {
  core::Config config;
  config.association.search = search;
  config.capacities.map_landmarks = 600;
  config.capacities.map_edges = 8000;
  config.capacities.scan_landmarks = 40;
  config.capacities.path_poses = 200;
  config.capacities.sightings = 6000;
  return config;
}

/// The range to the nearest of the trees (m, radius 0.3 m) along a bearing, or no return within 40 m.
double range_to_tree_m(const std::vector<core::Point2>& trees_L, double pan_rad) {
  constexpr double kRadius_m = 0.3;
  double nearest_m = 40.0;
  const core::Point2 direction(std::cos(pan_rad), std::sin(pan_rad));
  for (const core::Point2& tree : trees_L) {
    const double along_m = tree.dot(direction);
    const double half_chord2_m2 = kRadius_m * kRadius_m - (tree.squaredNorm() - along_m * along_m);
    if (along_m > 0.0 && half_chord2_m2 >= 0.0) {
      nearest_m = std::min(nearest_m, along_m - std::sqrt(half_chord2_m2));
    }
  }
  return nearest_m < 40.0 ? nearest_m : core::Reading::kNoReturn;
}

/// Scans of readings of trees, with room for `cells` occupied cells: a full turn of 0.1 deg at each tilt, and
/// now and then a reading that is none.
Walk readings_walk(core::LandmarkPoint point, std::uint32_t cells) {
  Draw draw(kSeed + 5);
  const Forest forest = make_forest(120, draw);
  core::Config config = small_config();
  config.detection.point = point;
  config.detection.discard_share = 0.0;
  config.capacities.occupied_cells = cells;
  const auto expect = [](const Walk& walk, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GE(count(fixes, FixStatus::Fix), 4);
    EXPECT_GE(fixes.back().landmarks_seen, 15U);
    EXPECT_GT(slam.detector().readings_refused(), 0U);
    EXPECT_EQ(slam.detector().cells_dropped() > 0, walk.config.capacities.occupied_cells < 1000);
  };
  Walk walk{config, {}, expect};
  for (int i = 0; i < 6; ++i) {
    const core::Pose2 pose_W{0.8 * i, -0.5 * i, 0.2 * i};
    std::vector<core::Point2> trees_L;
    std::transform(forest.trees_W.begin(), forest.trees_W.end(), std::back_inserter(trees_L),
                   [&](const core::Point2& tree_W) { return pose_W.inverse() * tree_W; });
    WalkScan scan;
    for (int line = 0; line < 5; ++line) {
      std::vector<core::Reading>& readings = scan.scanlines.emplace_back();
      for (int shot = 0; shot < 3600; ++shot) {
        const double pan_rad = 2.0 * std::numbers::pi * shot / 3600.0;
        readings.push_back({pan_rad, 0.01 * line, range_to_tree_m(trees_L, pan_rad)});
      }
      readings[draw.below(3600)].range_m = std::numeric_limits<double>::quiet_NaN();
      readings[draw.below(3600)].pan_rad = std::numeric_limits<double>::infinity();
    }
    scan.scanlines.emplace_back();  // an empty scanline
    walk.scans.push_back(scan);
  }
  return walk;
}

/// The best hypothesis of a walk under the paper's rule, or the home map.
core::MapState map_of(const Slam& slam, const Walk& walk) {
  static std::vector<core::MapLandmark> landmarks;
  static std::vector<core::Point2> positions_W;
  static std::vector<core::PathPose> path;
  landmarks.resize(walk.config.capacities.map_landmarks);
  positions_W.resize(walk.config.capacities.map_landmarks);
  path.resize(walk.config.capacities.path_poses);
  return slam.copy_map({landmarks, positions_W, path});
}

std::vector<WalkScan> stroll(const Forest& forest, int scans, double step_m, const ScanModel& model,
                             Draw& draw) {
  std::vector<WalkScan> walk;
  for (int i = 0; i < scans; ++i) {
    const core::Pose2 pose_W{step_m * (i - 0.5 * scans), 0.2 * i - 5.0, 0.3 * i};
    walk.push_back({as_landmarks(scan_forest(forest, pose_W, model, draw)), {}});
  }
  return walk;
}

Walk default_walk() {
  Draw draw(kSeed);
  const Forest forest = make_forest(300, draw);
  const auto expect = [](const Walk&, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GE(count(fixes, FixStatus::Fix), 20);
    EXPECT_GT(slam.maps().home_landmarks, 50U);
  };
  return {{}, stroll(forest, 25, 1.5, {30, 0.1, 3, 0.05}, draw), expect};
}

/// Every capacity is reached: of the scan, the map, its edges, its sightings and the path.
core::Config crowded_config(SearchMethod search) {
  core::Config config = small_config(search);
  config.capacities.scan_landmarks = 24;
  config.capacities.map_landmarks = 36;
  config.capacities.map_edges = 200;
  config.capacities.path_poses = 6;
  config.capacities.sightings = 100;
  return config;
}

Walk crowded_walk(SearchMethod search) {
  Draw draw(kSeed + 1);
  const Forest forest = make_forest(300, draw);
  const auto expect = [](const Walk& walk, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GE(count(fixes, FixStatus::Fix), 5);
    EXPECT_GT(map_of(slam, walk).landmarks_evicted, 0U);
    EXPECT_GT(map_of(slam, walk).path_thinnings, 1U);
    EXPECT_GT(slam.counters().landmarks_cut, 0U);
  };
  return {crowded_config(search), stroll(forest, 30, 1.5, {26, 0.0, 3, 0.05}, draw), expect};
}

/// The same under the paper's rule, which forgets nothing but what it evicts.
Walk crowded_paper_walk() {
  Draw draw(kSeed + 1);
  const Forest forest = make_forest(300, draw);
  core::Config config = crowded_config(SearchMethod::Paper);
  config.acceptance.rule = core::AcceptanceRule::Paper;
  const auto expect = [](const Walk& walk, const Slam& slam, const std::vector<Fix>& fixes) {
    const core::MapState best = map_of(slam, walk);
    EXPECT_GE(count(fixes, FixStatus::Fix), 20);
    EXPECT_EQ(best.landmarks.size(), walk.config.capacities.map_landmarks);
    EXPECT_GT(best.landmarks_evicted, 0U);
    EXPECT_EQ(best.landmarks_evicted + best.landmarks.size(), best.next_id)
        << "a landmark left uncounted, or counted twice";
    EXPECT_GT(best.path_thinnings, 1U);
    EXPECT_GT(slam.counters().landmarks_cut, 0U);
  };
  return {config, stroll(forest, 30, 1.5, {26, 0.0, 3, 0.05}, draw), expect};
}

/// Trees in rows and columns.
std::vector<core::Point2> plantation(int columns, double step_m) {
  std::vector<core::Point2> trees_W;
  for (int i = 0; i < columns * columns; ++i) {
    trees_W.emplace_back(step_m * (i % columns - 0.5 * (columns - 1)),
                         step_m * (i / columns - 0.5 * (columns - 1)));
  }
  return trees_W;
}

/// Each place of a plantation looks like many others.
Walk symmetric_walk(SearchMethod search) {
  const Forest rows{plantation(8, 4.0), 32.0};
  Draw draw(kSeed + 2);
  const auto expect = [](const Walk&, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GT(count(fixes, FixStatus::Ambiguous), 0);
    EXPECT_GT(count(fixes, FixReason::Symmetric), 0);
    EXPECT_EQ(slam.maps().home_landmarks, 40U);
  };
  Walk walk{small_config(search), {}, expect};
  walk.scans.push_back({as_landmarks(scan_forest(rows, {}, {40, 0.0, 0, 0.02}, draw)), {}});
  walk.scans.push_back({as_landmarks(scan_forest(rows, {0.3, 0.1, 0.2}, {12, 0.0, 0, 0.02}, draw)), {}});
  walk.scans.push_back({as_landmarks(scan_forest(rows, {0.6, 0.2, 0.4}, {12, 0.0, 0, 0.02}, draw)), {}});
  return walk;
}

/// Many edges within a tolerance of each other: a correspondence has more neighbours than are combined. Such
/// a vertex costs near a second, so only the first one is visited.
Walk dense_walk() {
  const Forest rows{plantation(9, 1.5), 13.5};
  core::Config config = small_config();
  config.capacities.scan_landmarks = core::kScanLandmarksMax;
  config.association.depth = 4;
  config.association.tolerance_m = 1.0;
  config.association.order_share = 1e-9;
  config.association.exhaust_when_unsure = false;
  config.acceptance.rule = core::AcceptanceRule::Paper;
  Draw draw(kSeed + 6);
  const auto expect = [](const Walk&, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GT(slam.counters().neighbours_dropped, 0U);
    EXPECT_EQ(fixes.back().search_end, core::SearchEnd::Share);
  };
  Walk walk{config, {}, expect};
  walk.scans.push_back({as_landmarks(scan_forest(rows, {}, {81, 0.0, 0, 0.02}, draw)), {}});
  walk.scans.push_back({as_landmarks(scan_forest(rows, {0.3, 0.1, 0.2}, {81, 0.0, 0, 0.02}, draw)), {}});
  return walk;
}

/// Scans that cannot be taken, cut searches, and new starts between them.
Walk refused_walk(SearchMethod search) {
  Draw draw(kSeed + 3);
  const Forest here = make_forest(100, draw);
  const Forest elsewhere = make_forest(100, draw);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto scan = [&](const Forest& forest) {
    return as_landmarks(scan_forest(forest, {}, {30, 0.1, 2, 0.05}, draw));
  };
  const auto expect = [](const Walk&, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GE(count(fixes, FixReason::TooFewLandmarks), 6);
    EXPECT_GE(count(fixes, FixReason::NoOverlap), 2);
    EXPECT_GE(count(fixes, FixReason::Deadline), 2);
    EXPECT_GE(count(fixes, FixStatus::Fix), 4);
    EXPECT_GT(slam.counters().landmarks_refused, 0U);
    EXPECT_GT(slam.counters().searches_cut, 0U);
  };
  Walk walk{small_config(search), {}, expect};
  for (int round = 0; round < 2; ++round) {
    walk.scans.push_back({{}, {}, WalkScan::kNoDeadline, true});
    walk.scans.push_back({{{{1.0, 2.0}, 1.0}, {{3.0, 4.0}, 1.0}}, {}});
    walk.scans.push_back({scan(here), {}});
    walk.scans.push_back({{}, {}});
    walk.scans.push_back(
        {{{{1.0, kNan}, 1.0}, {{kInfinity, 4.0}, 1.0}, {{1e300, 4.0}, kNan}, {{1, 1}, 1}}, {}});
    walk.scans.push_back({scan(elsewhere), {}});
    walk.scans.push_back({std::vector<core::ScanLandmark>(30, {{5.0, 5.0}, 1.0}), {}});  // all at one place
    walk.scans.push_back({scan(here), {}, 0});
    walk.scans.push_back({scan(here), {}});
  }
  return walk;
}

/// What is off by default, under the paper's rule: carried corrections, forgetting, robust fits, rivals of
/// equal standing.
Walk options_walk(core::LandmarkUpdate update) {
  Draw draw(kSeed + 4);
  const Forest forest = make_forest(200, draw);
  core::Config config = small_config();
  config.mapping = {core::kHypothesesMax, update, true, 0.6, 3};
  config.association.fit = core::PoseFit::Robust;
  config.association.tolerance_m = 1.0;
  config.acceptance.rule = core::AcceptanceRule::Paper;
  const auto expect = [](const Walk& walk, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GE(count(fixes, FixStatus::Fix), 15);
    EXPECT_GT(fixes.back().weight_runner_up, 0U) << "there is a single hypothesis";
    const core::MapState best = map_of(slam, walk);
    EXPECT_LT(best.landmarks.size() + best.landmarks_evicted, best.next_id) << "nothing was forgotten";
    EXPECT_TRUE(std::any_of(fixes.begin(), fixes.end(), [](const Fix& fix) { return fix.error_xi > 1; }));
  };
  return {config, stroll(forest, 30, 1.5, {24, 0.2, 3, 0.2}, draw), expect};
}

/// Kidnaps to two ends of a forest: local maps begin, grow, and are tied when the drive joins the ends.
Walk kidnapped_walk(SearchMethod search) {
  Draw draw(kSeed + 7);
  const Forest forest = make_forest(250, draw);
  const ScanModel model{26, 0.1, 2, 0.05};
  Walk walk{small_config(search), {}, nullptr};
  const auto drive = [&](double from_m, double to_m) {
    constexpr double kStep_m = 2.0;
    const double step_m = from_m < to_m ? kStep_m : -kStep_m;
    const int scans = static_cast<int>(std::abs(to_m - from_m) / kStep_m);
    for (int i = 0; i <= scans; ++i) {
      const core::Pose2 pose_W{from_m + step_m * i, 0.0, 0.3 * i};
      walk.scans.push_back({as_landmarks(scan_forest(forest, pose_W, model, draw)), {}});
    }
  };
  drive(-40.0, -30.0);
  drive(40.0, 30.0);
  drive(-30.0, 40.0);
  walk.expect_events = [](const Walk&, const Slam& slam, const std::vector<Fix>& fixes) {
    EXPECT_GE(count(fixes, FixReason::LocalMap), 2);
    EXPECT_GE(count(fixes, FixStatus::Fix), 25);
    EXPECT_EQ(slam.maps().local_maps, 0U) << "a local map was not tied";
  };
  return walk;
}

std::chrono::nanoseconds look(void* context) noexcept {
  return std::chrono::nanoseconds(++*static_cast<std::int64_t*>(context));
}

}  // namespace

void run(const Walk& walk, core::Slam& slam, std::vector<Fix>& fixes) noexcept {
  for (std::size_t i = 0; i < walk.scans.size(); ++i) {
    const WalkScan& scan = walk.scans[i];
    std::int64_t looks = 0;
    core::Deadline deadline;
    if (scan.looks != WalkScan::kNoDeadline) {
      deadline = {look, &looks, std::chrono::nanoseconds(scan.looks)};
    }
    if (scan.reset_before) {
      slam.reset();
    }
    for (const auto& scanline : scan.scanlines) {
      slam.add_scanline(scanline);
    }
    fixes[i] = scan.scanlines.empty() ? slam.process(scan.landmarks, {}, {}, deadline)
                                      : slam.finish_scan({}, deadline);
  }
}

std::vector<NamedWalk> all_walks() {
  using core::LandmarkPoint;
  using core::LandmarkUpdate;
  return {{"DefaultCapacities", default_walk},
          {"FullCapacities", [] { return crowded_walk(SearchMethod::Fast); }},
          {"FullCapacitiesByGraphs", [] { return crowded_walk(SearchMethod::Paper); }},
          {"FullCapacitiesUnderThePaperRule", crowded_paper_walk},
          {"Symmetric", [] { return symmetric_walk(SearchMethod::Fast); }},
          {"SymmetricByGraphs", [] { return symmetric_walk(SearchMethod::Paper); }},
          {"MoreNeighboursThanAreCombined", dense_walk},
          {"RefusedCutAndReset", [] { return refused_walk(SearchMethod::Fast); }},
          {"RefusedCutAndResetByGraphs", [] { return refused_walk(SearchMethod::Paper); }},
          {"Kidnapped", [] { return kidnapped_walk(SearchMethod::Fast); }},
          {"KidnappedByGraphs", [] { return kidnapped_walk(SearchMethod::Paper); }},
          {"PropagateUnderThePaperRule", [] { return options_walk(LandmarkUpdate::Paper); }},
          {"MeansUnderThePaperRule", [] { return options_walk(LandmarkUpdate::Mean); }},
          {"Readings", [] { return readings_walk(LandmarkPoint::HullCentroid, 65'536); }},
          {"ReadingsBeyondTheCells", [] { return readings_walk(LandmarkPoint::ReadingMean, 110); }}};
}

}  // namespace slamsensor::tests
