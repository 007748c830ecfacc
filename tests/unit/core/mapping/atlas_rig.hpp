#pragma once

#include "core/mapping/atlas.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <vector>

namespace slamsensor::core {

inline Config atlas_config() {
  Config c;
  c.capacities.map_landmarks = 800;
  c.capacities.map_edges = 12'000;
  c.capacities.scan_landmarks = 40;
  c.capacities.path_poses = 300;
  c.capacities.sightings = 8'000;
  return c;
}

inline constexpr tests::ScanModel kClear{28, 0.1, 2, 0.05};

/// An atlas on its way through a world whose truth is known.
class AtlasRig {
 public:
  explicit AtlasRig(const Config& config = atlas_config()) : atlas(config), config_(config) {}

  /// Takes a scan that was made at `truth`; a pose in a map has to be right, and a fix always.
  Fix process(const std::vector<Point2>& scan, const Pose2& truth, const ScanView& view = {},
              const Deadline& deadline = {}) {
    const Fix fix = atlas->process(tests::as_landmarks(scan), view, deadline);
    for (const MapEntry& map : atlas->maps()) {
      if (map.number != 0) {
        origins_.try_emplace(map.number, truth);  // its first scan is its origin
      }
    }
    ++scans;
    fixes += fix.status == FixStatus::Fix ? 1 : 0;
    if (fix.status == FixStatus::Fix || fix.reason == FixReason::LocalMap) {
      const bool is_right =
          origins_.count(fix.map) == 1 && tests::is_right(origins_.at(fix.map) * fix.pose_W, truth);
      wrong += is_right ? 0 : 1;
      EXPECT_TRUE(is_right) << "scan " << fix.scan << " in map " << fix.map;
      EXPECT_TRUE(fix.status != FixStatus::Fix || fix.map == fix.home);
    }
    return fix;
  }
  Fix look(const tests::Forest& forest, const Pose2& truth, tests::Draw& draw,
           const tests::ScanModel& model = kClear) {
    return process(tests::scan_forest(forest, truth, model, draw), truth);
  }
  /// Scans each `step_m` from `from` to `to`, turning. Returns the number of fixes.
  int drive(const tests::Forest& forest, const Point2& from, const Point2& to, tests::Draw& draw,
            double step_m = 2.0, const tests::ScanModel& model = kClear) {
    const int before = fixes;
    const int steps = static_cast<int>((to - from).norm() / step_m);
    for (int i = 0; i <= steps; ++i) {
      const Point2 p = from + (to - from) * (static_cast<double>(i) / steps);
      (void)look(forest, {p.x(), p.y(), 0.3 * i}, draw, model);
    }
    return fixes - before;
  }

  /// The home map with arrays of its own.
  struct Kept {
    std::vector<MapLandmark> landmarks;
    std::vector<Point2> positions_W;
    std::vector<PathPose> path;
    MapState state;  ///< views of them
  };
  [[nodiscard]] Kept keep() {
    Kept kept;
    kept.landmarks.resize(config_.capacities.map_landmarks);
    kept.positions_W.resize(config_.capacities.map_landmarks, Point2::Zero());
    kept.path.resize(config_.capacities.path_poses);
    kept.state = atlas->copy_home({kept.landmarks, kept.positions_W, kept.path});
    return kept;
  }
  [[nodiscard]] std::uint32_t maps_in_use() {
    std::uint32_t count = 0;
    for (const MapEntry& map : atlas->maps()) {
      count += map.number != 0 ? 1 : 0;
    }
    return count;
  }
  /// Where the frame of map `number` lies.
  [[nodiscard]] Pose2 origin(std::uint32_t number) const { return origins_.at(number); }
  void set_origin(std::uint32_t number, const Pose2& T) { origins_[number] = T; }

  tests::InArena<Atlas> atlas;
  int scans = 0;
  int fixes = 0;
  int wrong = 0;

 private:
  Config config_;
  std::map<std::uint32_t, Pose2> origins_;
};

}  // namespace slamsensor::core
