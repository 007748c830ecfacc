// A map that was kept and given back, and a map that is frozen.
#include "core/mapping/hypothesis_set.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;

Config test_config(std::uint32_t hypotheses_max) {
  Config c;
  c.capacities.map_landmarks = 600;
  c.capacities.map_edges = 8000;
  c.capacities.scan_landmarks = 40;
  c.capacities.path_poses = 200;
  c.mapping.hypotheses_max = hypotheses_max;
  return c;
}

/// A configuration that keeps three hypotheses alive.
Config several_config() {
  Config c = test_config(3);
  c.association.tolerance_m = 1.0;
  return c;
}

/// What a MapState says, with arrays of its own.
struct Kept {
  std::vector<MapLandmark> landmarks;
  std::vector<Point2> positions_W;
  std::vector<PathPose> path;
  MapState numbers;

  explicit Kept(const MapState& s)
      : landmarks(s.landmarks.begin(), s.landmarks.end()),
        positions_W(s.positions_W.begin(), s.positions_W.end()),
        path(s.path.begin(), s.path.end()),
        numbers(s) {}
  [[nodiscard]] MapState state() const {
    MapState s = numbers;
    s.landmarks = landmarks;
    s.positions_W = positions_W;
    s.path = path;
    return s;
  }
};

template <typename T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

/// Whether two states are equal bit for bit, the number of scans aside.
bool same_map(const MapState& a, const MapState& b) {
  return same_bytes(a.landmarks, b.landmarks) && same_bytes(a.positions_W, b.positions_W) &&
         same_bytes(a.path, b.path) && a.weight == b.weight && a.next_id == b.next_id &&
         a.landmarks_evicted == b.landmarks_evicted && a.path_thinnings == b.path_thinnings;
}

bool same_fix(const Fix& a, const Fix& b) {
  return a.scan == b.scan && a.status == b.status && a.reason == b.reason && a.search_end == b.search_end &&
         a.pose_W.x_m == b.pose_W.x_m && a.pose_W.y_m == b.pose_W.y_m &&
         a.pose_W.heading_rad == b.pose_W.heading_rad && a.covariance == b.covariance &&
         a.error_xi == b.error_xi && a.matches == b.matches && a.landmarks_in_map == b.landmarks_in_map &&
         a.expected_false_alarms == b.expected_false_alarms && a.weight_best == b.weight_best;
}

using Scans = std::vector<std::vector<ScanLandmark>>;

/// A walk of 40 scans through a forest, two of which see nothing.
Scans make_walk(std::uint64_t seed) {
  Draw draw(seed);
  const tests::Forest forest = tests::make_forest(150, draw);
  Scans scans;
  for (int i = 0; i < 40; ++i) {
    const Pose2 truth{-20.0 + 1.0 * i, 0.3 * i - 5.0, 0.3 * i};
    scans.push_back(tests::as_landmarks(tests::scan_forest(forest, truth, {24, 0.15, 2, 0.05}, draw)));
  }
  scans[7].clear();
  scans[19].clear();
  return scans;
}

std::vector<Fix> run(HypothesisSet& set, const Scans& scans, std::size_t begin, std::size_t end) {
  std::vector<Fix> fixes;
  for (std::size_t i = begin; i < end; ++i) {
    fixes.push_back(set.process(scans[i], {}));
  }
  return fixes;
}

TEST(Restore, ARunGoesOnAsIfNothingHadBeen) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Scans scans = make_walk(seed);
    tests::InArena<HypothesisSet> whole(test_config(1));
    const std::vector<Fix> expected = run(*whole, scans, 0, 40);
    tests::InArena<HypothesisSet> before(test_config(1));
    (void)run(*before, scans, 0, 20);
    const Kept kept(before->state());
    EXPECT_EQ(kept.numbers.scans, 20U);

    tests::InArena<HypothesisSet> after(test_config(1));
    ASSERT_TRUE(after->restore(kept.state()).ok());
    EXPECT_TRUE(same_map(after->state(), kept.state()));
    const std::vector<Fix> fixes = run(*after, scans, 20, 40);
    for (std::size_t i = 0; i < fixes.size(); ++i) {
      EXPECT_TRUE(same_fix(fixes[i], expected[20 + i])) << "seed " << seed << " scan " << 20 + i;
    }
    EXPECT_EQ(fixes[0].status, FixStatus::Fix) << "seed " << seed;
    EXPECT_TRUE(same_map(after->state(), whole->state())) << "seed " << seed;
  }
}

// With several hypotheses only the best is kept: the others' chance of overtaking it is lost, and nothing
// else.
TEST(Restore, OfSeveralHypothesesTheBestIsKept) {
  const Scans scans = make_walk(3);
  tests::InArena<HypothesisSet> before(several_config());
  (void)run(*before, scans, 0, 19);
  EXPECT_EQ(before->size(), 3U);
  const Kept kept(before->state());
  tests::InArena<HypothesisSet> after(several_config());
  ASSERT_TRUE(after->restore(kept.state()).ok());
  EXPECT_EQ(after->size(), 1U);
  EXPECT_TRUE(same_map(after->state(), kept.state()));
  EXPECT_EQ(after->process(scans[20], {}).status, FixStatus::Fix);
}

TEST(Restore, AFlawedStateChangesNothing) {
  const Scans scans = make_walk(1);
  tests::InArena<HypothesisSet> set(several_config());
  (void)run(*set, scans, 0, 10);
  const Kept before(set->state());
  const std::uint64_t revision = set->revision();
  Kept broken(set->state());
  broken.landmarks[3].id = broken.landmarks[2].id;
  const MapCheck check = set->restore(broken.state());
  EXPECT_EQ(check.flaw, MapFlaw::IdOrder);
  EXPECT_EQ(check.index, 3U);
  EXPECT_TRUE(same_map(set->state(), before.state()));
  EXPECT_EQ(set->revision(), revision);
  EXPECT_EQ(set->size(), 3U);
}

TEST(Restore, OverAnotherMapIsAJump) {
  const Scans scans = make_walk(1);
  tests::InArena<HypothesisSet> set(test_config(1));
  (void)run(*set, scans, 0, 10);
  const Kept ten(set->state());
  EXPECT_EQ(run(*set, scans, 10, 15).back().jumps, 0U);
  ASSERT_TRUE(set->restore(ten.state()).ok());
  const Fix fix = set->process(scans[10], {});
  EXPECT_EQ(fix.scan, 10U);
  EXPECT_EQ(fix.jumps, 1U);
}

TEST(Restore, ASetWithoutAMapHasAnEmptyState) {
  tests::InArena<HypothesisSet> set(test_config(1));
  EXPECT_TRUE(set->state().landmarks.empty());
  EXPECT_EQ(check_map(set->state(), test_config(1).capacities).flaw, MapFlaw::TooFewLandmarks);
}

TEST(Revision, GrowsWithEveryChangeOfTheBestMapAndWithNothingElse) {
  const Scans scans = make_walk(2);
  tests::InArena<HypothesisSet> set(several_config());
  EXPECT_EQ(set->revision(), 0U);
  for (const std::vector<ScanLandmark>& scan : scans) {
    const Kept before(set->state());
    const std::uint64_t revision = set->revision();
    (void)set->process(scan, {});
    EXPECT_EQ(set->revision() > revision, !same_map(set->state(), before.state()));
  }
  const std::uint64_t last = set->revision();
  EXPECT_GT(last, 30U);
  const Kept kept(set->state());
  set->reset();
  EXPECT_EQ(set->revision(), last + 1);
  set->reset();
  EXPECT_EQ(set->revision(), last + 1);
  ASSERT_TRUE(set->restore(kept.state()).ok());
  EXPECT_EQ(set->revision(), last + 2);
}

TEST(Frozen, LocalisesAndChangesNothingAtAll) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scans scans = make_walk(seed);
    Config config = seed % 2 == 0 ? several_config() : test_config(3);
    config.mapping.prune_share = 0.3;
    tests::InArena<HypothesisSet> set(config);
    (void)run(*set, scans, 0, 20);
    const Kept kept(set->state());
    const std::uint64_t revision = set->revision();
    const std::size_t hypotheses = set->size();
    tests::InArena<HypothesisSet> mapping(config);
    ASSERT_TRUE(mapping->restore(kept.state()).ok());
    set->set_frozen(Frozen::Yes);
    int fixes = 0;
    for (std::size_t i = 20; i < 40; ++i) {
      const Fix fix = set->process(scans[i], {});
      EXPECT_EQ(fix.scan, i);
      EXPECT_EQ(fix.jumps, 0U);
      EXPECT_EQ(fix.weight_best, kept.numbers.weight);
      fixes += fix.status == FixStatus::Fix ? 1 : 0;
      ASSERT_TRUE(same_map(set->state(), kept.state())) << "seed " << seed << " scan " << i;
      if (i == 20) {  // it says what a set that maps says of the same scan
        const Fix other = mapping->process(scans[i], {});
        EXPECT_EQ(fix.pose_W.x_m, other.pose_W.x_m);
        EXPECT_EQ(fix.matches, other.matches);
        EXPECT_EQ(fix.error_xi, other.error_xi);
      }
    }
    EXPECT_GE(fixes, 5) << "seed " << seed;
    EXPECT_EQ(set->revision(), revision);
    EXPECT_EQ(set->size(), hypotheses);
  }
}

TEST(Frozen, ThawedItMapsOn) {
  const Scans scans = make_walk(1);
  tests::InArena<HypothesisSet> set(test_config(1));
  (void)run(*set, scans, 0, 10);
  set->set_frozen(Frozen::Yes);
  (void)run(*set, scans, 10, 12);
  const std::uint64_t weight = set->state().weight;
  set->set_frozen(Frozen::No);
  EXPECT_EQ(set->process(scans[12], {}).status, FixStatus::Fix);
  EXPECT_GT(set->state().weight, weight);
  EXPECT_EQ(set->state().path.back().scan, 12U);
}

TEST(Frozen, WithoutAMapThereIsNoFixAndNoMap) {
  const Scans scans = make_walk(1);
  tests::InArena<HypothesisSet> set(test_config(1));
  set->set_frozen(Frozen::Yes);
  const Fix fix = set->process(scans[0], {});
  EXPECT_EQ(fix.status, FixStatus::NoFix);
  EXPECT_EQ(fix.reason, FixReason::NoOverlap);
  EXPECT_TRUE(set->empty());
  EXPECT_EQ(set->revision(), 0U);
}

}  // namespace
}  // namespace slamsensor::core
