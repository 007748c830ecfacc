// What becomes of the maps: ties, freezing, keeping and giving back, forgetting, and memory.
#include "core/mapping/atlas.hpp"
#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/core/mapping/atlas_rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

template <typename T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

bool same_map(const MapState& a, const MapState& b) {
  return same_bytes(a.landmarks, b.landmarks) && same_bytes(a.positions_W, b.positions_W) &&
         same_bytes(a.path, b.path) && a.weight == b.weight && a.next_id == b.next_id &&
         a.landmarks_evicted == b.landmarks_evicted;
}

/// Drives at both ends of a forest, then from one to the other: the map of the second end is local until
/// then.
void drive_both_ends(AtlasRig& rig, const Forest& forest, Draw& draw) {
  (void)rig.drive(forest, {-45, 0}, {-33, 0}, draw);
  const int before = rig.fixes;
  (void)rig.drive(forest, {45, 0}, {33, 0}, draw);
  EXPECT_EQ(rig.fixes, before);
  EXPECT_GE(rig.maps_in_use(), 2U);
  (void)rig.drive(forest, {-33, 0}, {45, 0}, draw);
}

// Not in every forest: in one of five the first scan after the jump has 2.97 of the three groups that it
// takes, and the map that it begins may then hold two places. Believing it took one copse for another in 83
// of 332 fixes.
TEST(AtlasMaps, LocalMapsThatOverlapAreTied) {
  int tied = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    drive_both_ends(rig, forest, draw);
    if (rig.maps_in_use() != 1U) {
      continue;
    }
    ++tied;
    const int before = rig.fixes;
    (void)rig.drive(forest, {45, 0}, {33, 0}, draw);
    EXPECT_GE(rig.fixes - before, 6) << "seed " << seed;
    // Each landmark of the map that was seen again and again is a tree, and no tree is there twice.
    const AtlasRig::Kept kept = rig.keep();
    const Pose2 T = rig.origin(rig.atlas->home()->number);
    for (std::size_t i = 0; i < kept.state.landmarks.size(); ++i) {
      if (kept.state.landmarks[i].sightings < 5) {
        continue;
      }
      double nearest_m = 1e9;
      for (const Point2& tree : forest.trees_W) {
        nearest_m = std::min(nearest_m, (T * kept.state.positions_W[i] - tree).norm());
      }
      EXPECT_LT(nearest_m, 0.5) << "seed " << seed;
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_TRUE(kept.state.landmarks[j].sightings < 2 ||
                    (kept.state.positions_W[i] - kept.state.positions_W[j]).norm() > 0.7)
            << "seed " << seed;
      }
    }
  }
  EXPECT_GE(tied, 4);
}

/// Once and a bit more round a ring, with a sensor that sees what is ahead turned a little to one side, so
/// that the map bends: the ring closes beyond the tolerance. Returns the error of the last pose, aligned
/// by the first.
double bent_ring(double bend_rad, int round_scans, int scans, const tests::ScanModel& model,
                 const Forest& forest, Draw& draw, tests::InArena<Atlas>& atlas) {
  constexpr double kRadius_m = 45.0;
  double error_m = 0.0;
  Pose2 origin;
  for (int i = 0; i < scans; ++i) {
    const double at_rad = 2.0 * std::numbers::pi * i / round_scans;
    const Pose2 truth{kRadius_m * std::cos(at_rad), kRadius_m * std::sin(at_rad),
                      at_rad + 0.5 * std::numbers::pi};
    std::vector<Point2> scan = tests::scan_forest(forest, truth, model, draw);
    for (Point2& p : scan) {
      p = Pose2{0.0, 0.0, bend_rad * p.x() / p.norm()} * p;
    }
    const Fix fix = atlas->process(tests::as_landmarks(scan), {}, {});
    origin = i == 0 ? truth : origin;
    error_m = fix.status == FixStatus::Fix
                  ? ((origin * fix.pose_W).translation() - truth.translation()).norm()
                  : 1e9;
  }
  return error_m;
}

TEST(AtlasMaps, ALoopThatComesBackBesideItselfIsClosed) {
  for (std::uint64_t seed = 21; seed <= 23; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(220, draw);
    tests::InArena<Atlas> atlas(atlas_config());
    EXPECT_LT(bent_ring(0.3 * kDegree, 130, 155, kClear, forest, draw, atlas), 1.0) << "seed " << seed;
    // No tree is there twice any more where the ring closed.
    const SightingGraph& graph = atlas->graph();
    std::size_t twice = 0;
    for (std::uint32_t a = 0; a < graph.slots(); ++a) {
      for (std::uint32_t b = 0; b < a; ++b) {
        twice += graph.is_used(a) && graph.is_used(b) && graph.landmark(a).map == graph.landmark(b).map &&
                         graph.standing()[a].sightings > 3 && graph.standing()[b].sightings > 3 &&
                         (graph.positions()[a] - graph.positions()[b]).norm() < 1.0
                     ? 1
                     : 0;
      }
    }
    EXPECT_LE(twice, 1U) << "seed " << seed;
  }
}

// Maps that are tied have more landmarks in common than a scan may have.
TEST(AtlasMaps, ATieTakesAsManyTwinsAsThereIsRoomFor) {
  const struct {
    std::uint64_t seed;
    double bend_rad;
    int round_scans;
  } rings[] = {{41, 0.3 * kDegree, 65}, {41, 1.0 * kDegree, 80}, {42, 1.0 * kDegree, 80}};
  for (const auto& ring : rings) {
    Draw draw(ring.seed);
    const Forest forest = tests::make_forest(220, draw);
    Config config = atlas_config();
    config.capacities.scan_landmarks = 20;
    tests::InArena<Atlas> atlas(config);
    (void)bent_ring(ring.bend_rad, ring.round_scans, 2 * ring.round_scans + 10, {28, 0.3, 3, 0.1}, forest,
                    draw, atlas);
    EXPECT_GT(atlas->home()->landmarks, 100U) << "seed " << ring.seed;
  }
}

// Posts in pairs, all alike, in a map from a file; a scan that shows one of each pair stands in two places of
// it. No scan is kept that could tell the pairs from layers: nothing is linked, and nothing moves.
TEST(AtlasMaps, PairsOfAMapFromAFileAreNoLayers) {
  Draw draw(31);
  const Forest forest = tests::make_forest(60, draw);
  Forest pairs = forest;
  for (const Point2& tree : forest.trees_W) {
    pairs.trees_W.emplace_back(tree + Point2(1.3, 0.5));
  }
  std::vector<MapLandmark> landmarks(pairs.trees_W.size());
  for (std::uint32_t id = 0; id < landmarks.size(); ++id) {
    landmarks[id].id = id;
    landmarks[id].sightings = landmarks[id].chances = 2;
  }
  MapState state;
  state.landmarks = landmarks;
  state.positions_W = pairs.trees_W;
  state.next_id = static_cast<std::uint32_t>(landmarks.size());
  state.scans = 5;
  tests::InArena<Atlas> atlas(atlas_config());
  ASSERT_TRUE(atlas->restore(state).ok());
  const std::vector<Point2> before(atlas->graph().positions().begin(), atlas->graph().positions().end());
  const std::vector<Point2> scan = tests::scan_forest(forest, {1.0, 0.5, 0.2}, {18, 0.0, 0, 0.05}, draw);
  EXPECT_NE(atlas->process(tests::as_landmarks(scan), {}, {}).status, FixStatus::Fix);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT((atlas->graph().positions()[i] - before[i]).norm(), 0.01) << i;
  }
}

TEST(AtlasMaps, AMapThatWasTiedCanBeGivenBack) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    drive_both_ends(rig, forest, draw);
    const AtlasRig::Kept kept = rig.keep();
    const MapCheck check = check_map(kept.state, atlas_config().capacities);
    EXPECT_TRUE(check.ok()) << "flaw " << static_cast<int>(check.flaw) << " at " << check.index;
    AtlasRig again;
    EXPECT_TRUE(again.atlas->restore(kept.state).ok());
  }
}

TEST(AtlasMaps, AMapThatIsGivenBackFindsItself) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    (void)rig.drive(forest, {-30, 0}, {30, 0}, draw);
    const AtlasRig::Kept kept = rig.keep();
    AtlasRig again;
    ASSERT_TRUE(again.atlas->restore(kept.state).ok());
    again.set_origin(1, rig.origin(rig.atlas->home()->number));
    EXPECT_TRUE(same_bytes(again.keep().state.landmarks, kept.state.landmarks));
    EXPECT_TRUE(same_bytes(again.keep().state.positions_W, kept.state.positions_W));
    const Fix fix = again.look(forest, {10, 1, 2}, draw);
    EXPECT_EQ(fix.status, FixStatus::Fix) << "seed " << seed;
    EXPECT_EQ(fix.scan, static_cast<std::uint32_t>(rig.scans));
    EXPECT_GE(again.drive(forest, {10, 0}, {40, 0}, draw), 15) << "seed " << seed;
  }
}

// After a restart the sensor knew nothing of where it looks, how far readings scatter and how the world
// repeats itself, and had to learn it anew.
TEST(AtlasMaps, WhatWasLearnedComesBackWithTheMap) {
  Draw draw(31);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  (void)rig.drive(forest, {-40, 0}, {40, 0}, draw);
  AtlasRig::Kept kept = rig.keep();
  ASSERT_TRUE(kept.state.rates);
  EXPECT_LT(kept.state.rates->structure_decades, Rates::kStartStructure);
  kept.state.rates->offset_m = 0.21;
  AtlasRig again;
  ASSERT_TRUE(again.atlas->restore(kept.state).ok());
  EXPECT_EQ(again.atlas->rates().spread_count, kept.state.rates->spread_count);
  EXPECT_EQ(again.atlas->rates().bearings, kept.state.rates->bearings);
  EXPECT_EQ(again.atlas->rates().structure_decades, kept.state.rates->structure_decades);
  EXPECT_EQ(again.keep().state.rates->offset_m, 0.21);
  kept.state.rates->shown[3] = -1.0F;
  EXPECT_EQ(again.atlas->restore(kept.state).flaw, MapFlaw::Rates);
  kept.state.rates.reset();
  ASSERT_TRUE(again.atlas->restore(kept.state).ok()) << "a map of a former version";
}

// The first save after a restart threw away the path of all scans before it.
TEST(AtlasMaps, ThePathOfBeforeComesBackWithTheMap) {
  Draw draw(32);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  (void)rig.drive(forest, {-40, 0}, {40, 0}, draw);
  const AtlasRig::Kept kept = rig.keep();
  ASSERT_GT(kept.state.path.size(), 5U);
  AtlasRig again;
  ASSERT_TRUE(again.atlas->restore(kept.state).ok());
  EXPECT_EQ(again.keep().state.path.size(), kept.state.path.size());
  (void)again.drive(forest, {-40, 0}, {40, 0}, draw);
  const AtlasRig::Kept longer = again.keep();
  ASSERT_GT(longer.state.path.size(), kept.state.path.size());
  for (std::size_t i = 0; i < kept.state.path.size(); ++i) {
    EXPECT_EQ(longer.state.path[i].scan, kept.state.path[i].scan);
  }
  EXPECT_TRUE(check_map(longer.state, atlas_config().capacities).ok());
}

TEST(AtlasMaps, AFlawedMapChangesNothing) {
  Draw draw(2);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  (void)rig.drive(forest, {-10, 0}, {10, 0}, draw);
  const AtlasRig::Kept before = rig.keep();
  AtlasRig::Kept broken = rig.keep();
  broken.landmarks[3].id = broken.landmarks[2].id;  // the state's views are of this array
  const std::uint64_t revision = rig.atlas->revision();
  EXPECT_EQ(rig.atlas->restore(broken.state).flaw, MapFlaw::IdOrder);
  EXPECT_TRUE(same_map(rig.keep().state, before.state));
  EXPECT_EQ(rig.atlas->revision(), revision);
}

TEST(AtlasMaps, AFrozenAtlasLocalisesAndChangesNothing) {
  Draw draw(3);
  const Forest forest = tests::make_forest(250, draw);
  const Forest elsewhere = tests::make_forest(100, draw);
  AtlasRig rig;
  (void)rig.drive(forest, {-30, 0}, {30, 0}, draw);
  (void)rig.drive(elsewhere, {-5, 0}, {5, 0}, draw);  // a local map beside it
  const AtlasRig::Kept kept = rig.keep();
  const std::uint64_t revision = rig.atlas->revision();
  const std::vector<Point2> places(rig.atlas->graph().positions().begin(),
                                   rig.atlas->graph().positions().end());
  const Rates rates = rig.atlas->rates();
  const std::uint32_t maps = rig.maps_in_use();
  rig.atlas->set_frozen(Frozen::Yes);
  const int before = rig.fixes;
  for (int i = 0; i < 20; ++i) {
    (void)rig.look(forest, {3.0 * i - 30.0, 2.0, 0.5 * i}, draw);
    (void)rig.look(elsewhere, {0.5 * i - 5.0, 2.0, 0.5 * i}, draw);
    (void)rig.process({}, {});
  }
  EXPECT_GE(rig.fixes - before, 18);
  EXPECT_TRUE(same_map(rig.keep().state, kept.state));
  EXPECT_EQ(rig.atlas->revision(), revision);
  EXPECT_EQ(std::vector<Point2>(rig.atlas->graph().positions().begin(), rig.atlas->graph().positions().end()),
            places);
  EXPECT_EQ(std::memcmp(&rates, &rig.atlas->rates(), sizeof rates), 0);
  EXPECT_EQ(rig.maps_in_use(), maps);
  rig.atlas->set_frozen(Frozen::No);
  EXPECT_EQ(rig.look(forest, {0, 0, 1}, draw).status, FixStatus::Fix);
  EXPECT_GT(rig.atlas->revision(), revision);
}

TEST(AtlasMaps, AFrozenAtlasWithoutAMapStartsNone) {
  Draw draw(4);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  rig.atlas->set_frozen(Frozen::Yes);
  EXPECT_EQ(rig.drive(forest, {-10, 0}, {10, 0}, draw), 0);
  EXPECT_EQ(rig.maps_in_use(), 0U);
  EXPECT_EQ(rig.atlas->revision(), 0U);
}

TEST(AtlasMaps, LandmarksThatAreGoneAreForgotten) {
  Draw draw(5);
  Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  (void)rig.drive(forest, {-30, 0}, {30, 0}, draw, 3.0);
  std::vector<Point2> felled;
  for (std::size_t i = 0; i < forest.trees_W.size();) {
    const Point2 tree = forest.trees_W[i];
    if (std::abs(tree.x()) < 20.0 && std::abs(tree.y()) < 8.0 && felled.size() < 6) {
      felled.push_back(tree);
      forest.trees_W.erase(forest.trees_W.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  ASSERT_EQ(felled.size(), 6U);
  const auto still_there = [&] {
    const AtlasRig::Kept kept = rig.keep();
    const Pose2 T = rig.origin(rig.atlas->home()->number);
    return std::count_if(felled.begin(), felled.end(), [&](const Point2& tree) {
      return std::any_of(kept.state.positions_W.begin(), kept.state.positions_W.end(),
                         [&](const Point2& p) { return (T * p - tree).norm() < 0.5; });
    });
  };
  EXPECT_GE(still_there(), 5);
  for (int round = 0; round < 3; ++round) {
    (void)rig.drive(forest, {30, 0}, {-30, 0}, draw, 3.0);
    (void)rig.drive(forest, {-30, 0}, {30, 0}, draw, 3.0);
  }
  EXPECT_EQ(still_there(), 0);
  EXPECT_GE(rig.fixes, rig.scans - 4);
}

Config small_config() {
  Config c = atlas_config();
  c.capacities.map_landmarks = 60;
  c.capacities.map_edges = 800;
  c.capacities.path_poses = 12;
  c.capacities.sightings = 200;
  return c;
}

TEST(AtlasMaps, FullMemoryKeepsTheSensorGoingAndNeverGivesAWrongFix) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(300, draw);
    AtlasRig rig(small_config());
    for (int round = 0; round < 3; ++round) {
      (void)rig.drive(forest, {-50, 0}, {50, 0}, draw);
      (void)rig.drive(forest, {50, 0}, {-50, 0}, draw);
    }
    EXPECT_GT(rig.atlas->landmarks_evicted(), 0U);
    EXPECT_GT(rig.atlas->graph().poses_folded(), 0U);
    EXPECT_LE(rig.atlas->graph().sightings_kept(), 200U);
    EXPECT_GE(rig.fixes, rig.scans / 3) << "seed " << seed;
    std::uint32_t landmarks = 0;
    for (const MapEntry& map : rig.atlas->maps()) {
      landmarks += map.landmarks;
    }
    EXPECT_EQ(landmarks, rig.atlas->graph().index().size())
        << "the maps' counts have lost touch with the landmarks";
  }
}

TEST(AtlasMaps, TakesNoMemory) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: a sanitizer's heap cannot be watched";
  }
  for (const SearchMethod search : {SearchMethod::Fast, SearchMethod::Paper}) {
    Draw draw(6);
    const Forest forest = tests::make_forest(250, draw);
    Config config = small_config();
    config.association.search = search;
    std::vector<std::vector<ScanLandmark>> scans;
    for (const double from_m : {-45.0, 45.0, -33.0}) {
      for (int i = 0; i < (from_m == -33.0 ? 40 : 7); ++i) {
        const double x_m = from_m + 2.0 * i * (from_m > 0.0 ? -1.0 : 1.0);
        scans.push_back(tests::as_landmarks(tests::scan_forest(forest, {x_m, 0, 0.3 * i}, kClear, draw)));
      }
    }
    AtlasRig rig(config);
    std::uint64_t calls = 0;
    for (const auto& scan : scans) {
      const tests::NoAllocScope scope;
      (void)rig.atlas->process(scan, {}, {});
      calls += scope.heap_calls();
    }
    const AtlasRig::Kept kept = rig.keep();
    {
      const tests::NoAllocScope scope;
      (void)rig.atlas->restore(kept.state);
      rig.atlas->reset();
      calls += scope.heap_calls();
    }
    EXPECT_EQ(calls, 0U);
  }
}

}  // namespace
}  // namespace slamsensor::core
