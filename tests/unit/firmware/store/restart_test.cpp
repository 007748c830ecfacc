// What the store is for: a sensor that was switched off finds itself in its map on its first scan.
#include "core/slam.hpp"
#include "firmware/store/map_snapshot.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"
#include "tests/unit/firmware/store/store_bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

namespace slamsensor::firmware {
namespace {

using tests::StoreBench;

core::Config test_config(std::uint32_t hypotheses_max,
                         core::AcceptanceRule rule = core::AcceptanceRule::Paper) {
  core::Config c;
  c.acceptance.rule = rule;
  c.mapping.hypotheses_max = hypotheses_max;
  c.capacities.map_landmarks = 600;
  c.capacities.map_edges = 8000;
  c.capacities.scan_landmarks = 40;
  c.capacities.path_poses = 200;
  c.capacities.occupied_cells = 16;
  return c;
}

std::vector<std::vector<core::ScanLandmark>> make_walk(std::uint64_t seed) {
  tests::Draw draw(seed);
  const tests::Forest forest = tests::make_forest(150, draw);
  std::vector<std::vector<core::ScanLandmark>> scans;
  for (int i = 0; i < 40; ++i) {
    const core::Pose2 truth{-20.0 + 1.0 * i, 0.3 * i - 5.0, 0.3 * i};
    scans.push_back(tests::as_landmarks(tests::scan_forest(forest, truth, {24, 0.15, 2, 0.05}, draw)));
  }
  return scans;
}

constexpr std::size_t kBreak = 20;  // scans before the sensor is switched off

/// The fixes of the walk's later scans, of a sensor that was switched off before them and has its map from
/// the store.
std::vector<core::Fix> with_restart(const core::Config& config,
                                    const std::vector<std::vector<core::ScanLandmark>>& scans) {
  tests::InArena<core::Slam> first(config);
  for (std::size_t i = 0; i < kBreak; ++i) {
    (void)first->process(scans[i], {}, {}, {});
  }
  MapSnapshot snapshot(config.capacities);
  snapshot.take(*first);
  StoreBench bench;
  MapAbout about;
  about.name = "m";
  EXPECT_TRUE(bench.store.save(about, snapshot.state(), tests::kNow_utc_s));
  const auto loaded = bench.store.load("m");
  tests::InArena<core::Slam> second(config);
  EXPECT_TRUE(loaded && second->restore(loaded->file.state()).ok());
  std::vector<core::Fix> fixes;
  for (std::size_t i = kBreak; i < scans.size(); ++i) {
    const core::ScanTime time{{}, std::chrono::seconds(i), {}, std::chrono::seconds(i)};
    fixes.push_back(second->process(scans[i], {}, time, {}));
  }
  return fixes;
}

std::vector<core::Fix> without_restart(const core::Config& config,
                                       const std::vector<std::vector<core::ScanLandmark>>& scans) {
  tests::InArena<core::Slam> slam(config);
  std::vector<core::Fix> fixes;
  for (const auto& scan : scans) {
    fixes.push_back(slam->process(scan, {}, {}, {}));
  }
  return {fixes.begin() + kBreak, fixes.end()};
}

bool same_place(const core::Fix& a, const core::Fix& b) {
  return a.status == b.status && a.pose_W.x_m == b.pose_W.x_m && a.pose_W.y_m == b.pose_W.y_m &&
         a.pose_W.heading_rad == b.pose_W.heading_rad && a.covariance == b.covariance &&
         a.weight_best == b.weight_best;
}

TEST(Restart, TheFirstScanFindsItselfInTheLoadedMapAsIfNothingHadBeen) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto scans = make_walk(seed);
    const auto expected = without_restart(test_config(1), scans);
    const auto fixes = with_restart(test_config(1), scans);
    EXPECT_EQ(fixes[0].status, core::FixStatus::Fix) << "seed " << seed;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      EXPECT_TRUE(same_place(fixes[i], expected[i])) << "seed " << seed << " scan " << kBreak + i;
      EXPECT_EQ(fixes[i].scan, kBreak + i);
      EXPECT_EQ(fixes[i].time.middle_utc, std::chrono::seconds(kBreak + i));
    }
  }
}

// What the refinement remembers of single scans is not in the store: places differ by what it would have made
// of them.
TEST(Restart, TheProductsFixesGoOnInTheSameFrame) {
  const core::Config config = test_config(3, core::AcceptanceRule::Evidence);
  double worst_m = 0.0;
  int found = 0;  // in one of five the scan alone does not tell its place from a copy; without a restart the
                  // scan before does
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto scans = make_walk(seed);
    const auto expected = without_restart(config, scans);
    const auto fixes = with_restart(config, scans);
    if (fixes[0].status != core::FixStatus::Fix) {
      EXPECT_EQ(fixes[0].reason, core::FixReason::Copy) << "seed " << seed;
      continue;
    }
    ++found;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      EXPECT_EQ(fixes[i].scan, kBreak + i);
      EXPECT_EQ(fixes[i].status, expected[i].status) << "seed " << seed << " scan " << kBreak + i;
      worst_m = std::max(worst_m, (fixes[i].pose_W.translation() - expected[i].pose_W.translation()).norm());
    }
  }
  std::printf("after a restart fixes are at most %.3f m from where they would have been\n", worst_m);
  EXPECT_LT(worst_m, 0.15);
  EXPECT_GE(found, 4);
}

// The store keeps the best hypothesis. Where another would have overtaken it later, the fixes go their own
// way; they are right nevertheless.
TEST(Restart, OfSeveralHypothesesTheBestGoesOn) {
  int same = 0;
  int all = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto scans = make_walk(seed);
    const auto expected = without_restart(test_config(3), scans);
    const auto fixes = with_restart(test_config(3), scans);
    EXPECT_EQ(fixes[0].status, core::FixStatus::Fix) << "seed " << seed;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      ++all;
      same += same_place(fixes[i], expected[i]) ? 1 : 0;
      if (fixes[i].status == core::FixStatus::Fix && expected[i].status == core::FixStatus::Fix) {
        EXPECT_TRUE(tests::is_right(fixes[i].pose_W, expected[i].pose_W)) << "seed " << seed << " scan " << i;
      }
    }
  }
  std::printf("fixes after a restart with three hypotheses: %d of %d the same bit for bit\n", same, all);
  EXPECT_GT(same, all / 2);
}

TEST(Restart, AMapOfManyScansTakesNoMoreThanItsCapacities) {
  const core::Config config = test_config(3, core::AcceptanceRule::Evidence);
  MapSnapshot snapshot(config.capacities);
  tests::InArena<core::Slam> slam(config);
  snapshot.take(*slam);
  EXPECT_TRUE(snapshot.empty());
  (void)slam->process(make_walk(1)[0], {}, {}, {});
  snapshot.take(*slam);
  EXPECT_FALSE(snapshot.empty());
  EXPECT_EQ(snapshot.revision(), slam->revision());
  const MapSnapshot copy = snapshot;
  EXPECT_EQ(copy.state().landmarks.size(), slam->maps().home_landmarks);
  EXPECT_NE(copy.state().landmarks.data(), snapshot.state().landmarks.data());

  core::Capacities small;
  small.map_landmarks = 2;
  MapSnapshot narrow(small);
  narrow.take(*slam);
  EXPECT_LE(narrow.state().landmarks.size(), 2U);
}

}  // namespace
}  // namespace slamsensor::firmware
