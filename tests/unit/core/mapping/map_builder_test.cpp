#include "core/mapping/map_builder.hpp"

#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;

Config small_config() {
  Config c;
  c.capacities.map_landmarks = 30;
  c.capacities.map_edges = 400;
  c.capacities.scan_landmarks = 20;
  c.capacities.path_poses = 4;
  return c;
}

std::vector<Point2> ring(int count, double radius_m) {
  std::vector<Point2> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(radius_m * std::cos(0.5 * i), radius_m * std::sin(0.5 * i));
  }
  return points;
}

/// Every scan landmark i < matched is matched with map landmark i.
Candidate straight(std::uint32_t matched) {
  Candidate c;
  for (std::uint32_t i = 0; i < matched; ++i) {
    EXPECT_TRUE(c.matches.try_push_back({i, i}));
  }
  c.triangle = {0, 1, 2};
  return c;
}

TEST(MapBuilder, TheFirstScanIsTheOrigin) {
  const Config config = small_config();
  tests::InArena<Hypothesis> h(config.capacities);
  tests::InArena<MapBuilder> builder(config);
  builder->start(ring(6, 10.0), 3, *h);
  ASSERT_EQ(h->map.size(), 6U);
  for (const MapLandmark& l : h->map.landmarks()) {
    EXPECT_EQ(l.xi, 0U);
    EXPECT_EQ(l.first_scan, 3U);
  }
  ASSERT_EQ(h->path.size(), 1U);
  EXPECT_EQ(h->path[0].pose_W.x_m, 0.0);
  EXPECT_EQ(h->weight, 0U);
}

TEST(MapBuilder, NewLandmarksEnterWithTheScansError) {
  const Config config = small_config();
  tests::InArena<Hypothesis> h(config.capacities);
  tests::InArena<MapBuilder> builder(config);
  builder->start(ring(5, 10.0), 0, *h);
  std::vector<Point2> scan = ring(5, 10.0);
  scan.emplace_back(30, 30);
  builder->extend(scan, straight(5), 1, *h);
  ASSERT_EQ(h->map.size(), 6U);
  EXPECT_EQ(h->map.landmarks()[5].xi, 1U);
  EXPECT_EQ(h->map.landmarks()[5].id, 5U);
  EXPECT_EQ(h->map.landmarks()[5].parents, (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(h->weight, 5U);
  EXPECT_EQ(h->path.back().xi, 1U);
}

TEST(MapBuilder, AFullMapLosesItsLeastUsefulLandmarks) {
  Config config = small_config();
  config.capacities.map_landmarks = 8;
  tests::InArena<Hypothesis> h(config.capacities);
  tests::InArena<MapBuilder> builder(config);
  builder->start(ring(8, 10.0), 0, *h);
  // The first five are seen again and again, then three newcomers arrive: they replace the three never seen
  // again.
  for (std::uint32_t scan = 1; scan < 4; ++scan) {
    builder->extend(ring(5, 10.0), straight(5), scan, *h);
  }
  std::vector<Point2> scan = ring(5, 10.0);
  scan.insert(scan.end(), {{40, 0}, {44, 9}, {39, -8}});
  builder->extend(scan, straight(5), 4, *h);
  ASSERT_EQ(h->map.size(), 8U);
  EXPECT_EQ(h->landmarks_evicted, 3U);
  std::set<std::uint32_t> ids;
  for (const MapLandmark& l : h->map.landmarks()) {
    ids.insert(l.id);
  }
  EXPECT_EQ(ids, (std::set<std::uint32_t>{0, 1, 2, 3, 4, 8, 9, 10}));
  EXPECT_FALSE(h->map.find(6).has_value());
  EXPECT_EQ(h->map.find(9).value(), 6U);
}

TEST(MapBuilder, AFullPathIsThinnedAndGoesOn) {
  const Config config = small_config();  // 4 poses
  tests::InArena<Hypothesis> h(config.capacities);
  tests::InArena<MapBuilder> builder(config);
  builder->start(ring(5, 10.0), 0, *h);
  for (std::uint32_t scan = 1; scan < 6; ++scan) {
    builder->extend(ring(5, 10.0), straight(5), scan, *h);
  }
  ASSERT_EQ(h->path.size(), 4U);
  EXPECT_EQ(h->path[0].scan, 0U);
  EXPECT_EQ(h->path[1].scan, 2U);
  EXPECT_EQ(h->path.back().scan, 5U);
  EXPECT_EQ(h->path_thinnings, 1U);
}

TEST(MapBuilder, PrunesWhatShouldHaveBeenSeenAndWasNot) {
  Config config = small_config();
  config.mapping.prune_share = 0.4;
  config.mapping.prune_chances_min = 3;
  tests::InArena<Hypothesis> h(config.capacities);
  tests::InArena<MapBuilder> builder(config);
  std::vector<Point2> first = ring(12, 10.0);
  first.emplace_back(2.0, 2.0);    // inside the ring: a ghost
  first.emplace_back(50.0, 50.0);  // outside: never a chance to see it
  builder->start(first, 0, *h);
  for (std::uint32_t scan = 1; scan < 4; ++scan) {
    builder->extend(ring(12, 10.0), straight(12), scan, *h);
  }
  EXPECT_FALSE(h->map.find(12).has_value());
  EXPECT_TRUE(h->map.find(13).has_value());
  EXPECT_EQ(h->map.size(), 13U);
}

TEST(MapBuilder, ThePaperNeverPrunes) {
  const Config config = small_config();
  tests::InArena<Hypothesis> h(config.capacities);
  tests::InArena<MapBuilder> builder(config);
  std::vector<Point2> first = ring(12, 10.0);
  first.emplace_back(2.0, 2.0);
  builder->start(first, 0, *h);
  for (std::uint32_t scan = 1; scan < 10; ++scan) {
    builder->extend(ring(12, 10.0), straight(12), scan, *h);
  }
  EXPECT_EQ(h->map.size(), 13U);
}

}  // namespace
}  // namespace slamsensor::core
