#include "core/mapping/positional_error.hpp"

#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::core {
namespace {

Capacities small() {
  Capacities c;
  c.map_landmarks = 20;
  c.map_edges = 200;
  c.scan_landmarks = 20;
  return c;
}

MapLandmark landmark(std::uint32_t id, std::uint32_t xi, std::array<std::uint32_t, 3> parents) {
  MapLandmark l;
  l.id = id;
  l.xi = xi;
  l.parents = parents;
  return l;
}

constexpr std::array<std::uint32_t, 3> kOrigin{MapLandmark::kNoParent, MapLandmark::kNoParent,
                                               MapLandmark::kNoParent};

/// Three landmarks of the first scan, one triangulated from them, one triangulated from that one, and a
/// stranger.
void fill(LandmarkMap& map) {
  ASSERT_TRUE(map.try_add(landmark(0, 0, kOrigin), {0, 0}));
  ASSERT_TRUE(map.try_add(landmark(1, 0, kOrigin), {10, 0}));
  ASSERT_TRUE(map.try_add(landmark(2, 0, kOrigin), {0, 10}));
  ASSERT_TRUE(map.try_add(landmark(3, 2, {0, 1, 2}), {20, 20}));
  ASSERT_TRUE(map.try_add(landmark(4, 3, {1, 2, 3}), {30, 25}));
  ASSERT_TRUE(map.try_add(landmark(5, 4, {0, 1, 4}), {40, 40}));
}

TEST(PositionalError, OfAScanIsOneMoreThanItsWorstTriangulatingLandmark) {
  tests::InArena<LandmarkMap> map(small());
  fill(*map);
  EXPECT_EQ(PositionalError::of_scan(*map, {0, 1, 2}), 1U);
  EXPECT_EQ(PositionalError::of_scan(*map, {0, 3, 1}), 3U);
  EXPECT_EQ(PositionalError::of_scan(*map, {5, 4, 3}), 5U);
}

TEST(PositionalError, MovesMatchedLandmarksThatAreNotBetterKnown) {
  tests::InArena<LandmarkMap> map(small());
  fill(*map);
  tests::InArena<PositionalError> error(MappingConfig{}, small());
  // Seen from the origin, everything half a metre to the right. The scan's xi is 1.
  const std::vector<Point2> scan{{0.5, 0}, {10.5, 0}, {0.5, 10}, {20.5, 20}};
  const std::vector<Match> matches{{0, 0}, {1, 1}, {2, 2}, {3, 3}};
  EXPECT_EQ(error->update_matched({Pose2{}, matches, scan, {0, 1, 2}, 7}, *map), 1U);
  EXPECT_EQ(map->position_W(0), Point2(0, 0));  // xi 0 is smaller than 1: stays
  EXPECT_EQ(map->landmark(0).xi, 0U);
  EXPECT_EQ(map->position_W(3), Point2(20.5, 20));
  EXPECT_EQ(map->landmark(3).xi, 1U);
  EXPECT_EQ(map->landmark(3).parents, (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(map->landmark(3).sightings, 2U);
  EXPECT_EQ(map->landmark(3).last_scan, 7U);
  EXPECT_EQ(map->position_W(4), Point2(30, 25));  // not matched, nothing propagated
}

TEST(PositionalError, EqualErrorMovesToo) {
  tests::InArena<LandmarkMap> map(small());
  fill(*map);
  tests::InArena<PositionalError> error(MappingConfig{}, small());
  const std::vector<Point2> scan{{31, 25}};
  const std::vector<Match> matches{{0, 4}};
  EXPECT_EQ(error->update_matched({Pose2{}, matches, scan, {0, 1, 3}, 7}, *map), 3U);
  EXPECT_EQ(map->position_W(4), Point2(31, 25));
}

TEST(PositionalError, PropagatesCorrectionsToWhatWasTriangulatedFromThem) {
  tests::InArena<LandmarkMap> map(small());
  fill(*map);
  // Landmark 6's parents all move by (1, 2): it must follow exactly.
  ASSERT_TRUE(map->try_add(landmark(6, 5, {3, 4, 5}), {50, 50}));
  MappingConfig config;
  config.propagate_corrections = true;
  tests::InArena<PositionalError> error(config, small());
  const std::vector<Point2> scan{{21, 22}, {31, 27}, {41, 42}};
  const std::vector<Match> matches{{0, 3}, {1, 4}, {2, 5}};
  error->update_matched({Pose2{}, matches, scan, {0, 1, 2}, 7}, *map);
  EXPECT_NEAR((map->position_W(6) - Point2(51, 52)).norm(), 0.0, 1e-9);
}

TEST(PositionalError, PropagationReachesGrandchildrenAndSparesTheUntouched) {
  tests::InArena<LandmarkMap> map(small());
  fill(*map);
  ASSERT_TRUE(map->try_add(landmark(6, 2, {0, 1, 2}), {-20, -20}));
  MappingConfig config;
  config.propagate_corrections = true;
  tests::InArena<PositionalError> error(config, small());
  const std::vector<Point2> scan{{20.3, 20}};
  const std::vector<Match> matches{{0, 3}};
  error->update_matched({Pose2{}, matches, scan, {0, 1, 2}, 7}, *map);
  EXPECT_GT((map->position_W(4) - Point2(30, 25)).norm(), 0.01);   // child of 3
  EXPECT_GT((map->position_W(5) - Point2(40, 40)).norm(), 0.001);  // child of 4
  EXPECT_EQ(map->position_W(6), Point2(-20, -20));                 // its parents stand still
}

TEST(PositionalError, MeanUpdateAveragesSightings) {
  tests::InArena<LandmarkMap> map(small());
  fill(*map);
  MappingConfig config;
  config.update = LandmarkUpdate::Mean;
  tests::InArena<PositionalError> error(config, small());
  const std::vector<Point2> scan{{0.6, 0}};
  const std::vector<Match> matches{{0, 0}};
  error->update_matched({Pose2{}, matches, scan, {0, 1, 2}, 1}, *map);
  EXPECT_NEAR(map->position_W(0).x(), 0.3, 1e-12);
  error->update_matched({Pose2{}, matches, scan, {0, 1, 2}, 2}, *map);
  EXPECT_NEAR(map->position_W(0).x(), 0.4, 1e-12);
  EXPECT_EQ(map->landmark(0).xi, 0U);
}

}  // namespace
}  // namespace slamsensor::core
