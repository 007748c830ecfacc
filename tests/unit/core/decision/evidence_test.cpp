#include "core/decision/evidence.hpp"

#include "core/association/fast_search.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

Capacities capacities_of(const Forest& forest) {
  Capacities c;
  c.scan_landmarks = 64;
  c.map_landmarks = static_cast<std::uint32_t>(forest.trees_W.size() + 10);
  return c;
}

/// A forest that is mapped, and was looked at all over.
class Mapped {
 public:
  explicit Mapped(Forest forest)
      : positions(std::move(forest.trees_W)),
        standing(positions.size() + 10, Standing{5, 6}),
        capacities_(capacities_of({positions, 0.0})),
        index(AssociationConfig{}, capacities_),
        ground(capacities_),
        search_(AssociationConfig{}, capacities_) {
    for (std::uint32_t slot = 0; slot < positions.size(); ++slot) {
      index->insert(slot, 0, positions[slot]);
    }
    rates.bearings.fill(100.0F);
    for (double x = -0.5 * forest.side_m; x < 0.5 * forest.side_m; x += 4.0) {
      for (double y = -0.5 * forest.side_m; y < 0.5 * forest.side_m; y += 4.0) {
        for (int look = 0; look < 4; ++look) {
          ground->look(0, {x, y}, 0.7);
        }
      }
    }
  }
  Evidence weigh(const std::vector<Point2>& scan, Candidate& candidate) {
    Witnesses witnesses;
    witnesses.points_B = scan;
    witnesses.sizes = sizes;
    witnesses.view = &view;
    witnesses.is_surveyed = is_surveyed;
    witnesses.sensor_reach_m = sensor_reach_m;
    return scale_.weigh(witnesses, {*index, positions, standing, *ground, rates}, candidate);
  }
  /// Of the confirmed landmarks of a local map that lies as this one does.
  Evidence weigh_map(const std::vector<Point2>& confirmed, MapSlot own_map, Candidate& candidate) {
    Witnesses witnesses;
    witnesses.points_B = confirmed;
    witnesses.own_map = own_map;
    return scale_.weigh(witnesses, {*index, positions, standing, *ground, rates}, candidate);
  }
  Evidence weigh_at(const std::vector<Point2>& scan, const Pose2& pose) {
    Candidate candidate;
    candidate.pose_W = pose;
    return weigh(scan, candidate);
  }
  /// The largest of the evidence of all poses that the search finds.
  double most_nats(const std::vector<Point2>& scan) {
    search_->search(scan, *index, positions, kNoMap, {}, {}, *found_);
    double most = -1e9;
    for (Candidate& candidate : found_->list) {
      most = std::max(most, weigh(scan, candidate).ln_bayes);
    }
    return most;
  }

  std::vector<Point2> positions;
  std::vector<Standing> standing;
  Rates rates;
  ScanView view;
  std::vector<LandmarkSize> sizes;  // of the scan's landmarks
  bool is_surveyed = false;
  double sensor_reach_m = 0.0;

 private:
  Capacities capacities_;

 public:
  tests::InArena<LandmarkIndex> index;
  tests::InArena<ExploredGround> ground;

 private:
  tests::InArena<FastSearch> search_;
  EvidenceScale scale_{AssociationConfig{}, AcceptanceConfig{}};
  std::unique_ptr<Candidates> found_ = std::make_unique<Candidates>();
};

// Whatever number of poses is tried, a foreign scan reaches a Bayes factor of t with a chance of 1 / t at
// most.
TEST(Evidence, ForeignScansSeldomSpeakForAPlace) {
  int scans = 0;
  std::vector<double> decades;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Draw draw(600 + seed);
    Mapped mapped(tests::make_forest(180, draw));
    const Forest elsewhere = tests::make_forest(180, draw);
    for (int i = 0; i < 200; ++i, ++scans) {
      const auto scan = tests::scan_forest(elsewhere, tests::pose_in(elsewhere, draw), {}, draw);
      decades.push_back(mapped.most_nats(scan) / std::numbers::ln10);
    }
  }
  for (const double t : {1.0, 2.0, 3.0}) {
    const auto above = std::count_if(decades.begin(), decades.end(), [&](double d) { return d > t; });
    const double expected = scans * std::pow(10.0, -t);
    EXPECT_LE(static_cast<double>(above), expected + 3.0 * std::sqrt(expected) + 1.0) << t << " decades";
  }
}

TEST(Evidence, TrueScansSpeakLoudly) {
  Draw draw(21);
  const Forest forest = tests::make_forest(180, draw);
  Mapped mapped(forest);
  int loud = 0;
  for (int i = 0; i < 50; ++i) {
    const Pose2 truth = tests::pose_in(forest, draw);
    const auto scan = tests::scan_forest(forest, truth, {}, draw);
    const Evidence evidence = mapped.weigh_at(scan, truth);
    loud += evidence.ln_bayes > 6.0 * std::numbers::ln10 ? 1 : 0;
    EXPECT_GT(evidence.covariance(0, 0), 0.0);
    EXPECT_GE(evidence.explored, evidence.unmatched);
    EXPECT_GE(evidence.in_view, evidence.missing);
  }
  EXPECT_GE(loud, 45);
}

TEST(Evidence, LandmarksOfTheScanThatTheMapLacksSpeakAgainstIt) {
  Draw draw(22);
  const Forest forest = tests::make_forest(180, draw);
  Mapped mapped(forest);
  auto scan = tests::scan_forest(forest, {}, {24, 0.0, 0, 0.05}, draw);
  Evidence before = mapped.weigh_at(scan, {});
  EXPECT_EQ(before.unmatched, 0U);
  EXPECT_EQ(before.log10_unmatched, 0.0);
  for (int extra = 0; extra < 6;) {
    const Point2 p{draw.uniform(-15.0, 15.0), draw.uniform(-15.0, 15.0)};
    double d2 = 0.0;
    if (mapped.index->nearest_within(0, p, 2.0, d2) != LandmarkIndex::kNone) {
      continue;
    }
    scan.push_back(p);
    const Evidence after = mapped.weigh_at(scan, {});
    EXPECT_EQ(after.unmatched, static_cast<std::uint32_t>(++extra));
    EXPECT_LT(after.ln_bayes, before.ln_bayes);
    EXPECT_LT(after.log10_unmatched, before.log10_unmatched);
    before = after;
  }
}

TEST(Evidence, OnNewGroundNothingIsUnmatched) {
  Draw draw(23);
  const Forest forest = tests::make_forest(180, draw);
  Mapped mapped(forest);
  auto scan = tests::scan_forest(forest, {}, {24, 0.0, 0, 0.05}, draw);
  const Evidence before = mapped.weigh_at(scan, {});
  mapped.ground->clear();
  mapped.ground->look(0, {500.0, 500.0}, 0.5);
  scan.push_back({1.0, 1.0});
  EXPECT_LE(mapped.weigh_at(scan, {}).log10_unmatched, 0.0);
  EXPECT_EQ(mapped.weigh_at(scan, {}).unmatched, 0U);
  EXPECT_EQ(before.unmatched, 0U);
}

TEST(Evidence, LandmarksOfTheMapThatAreNotShownSpeakAgainstIt) {
  Draw draw(24);
  const Forest forest = tests::make_forest(180, draw);
  Mapped mapped(forest);
  auto scan = tests::scan_forest(forest, {}, {24, 0.0, 0, 0.05}, draw);
  std::sort(scan.begin(), scan.end(), [](const Point2& a, const Point2& b) { return a.norm() > b.norm(); });
  Evidence before = mapped.weigh_at(scan, {});
  for (int gone = 1; gone <= 8; ++gone) {
    scan.pop_back();  // the nearest; the farthest says how far the scan saw
    const Evidence after = mapped.weigh_at(scan, {});
    EXPECT_EQ(after.missing, before.missing + 1);
    EXPECT_LT(after.ln_bayes, before.ln_bayes);
    EXPECT_LT(after.log10_missing, before.log10_missing);
    before = after;
  }
}

TEST(Evidence, WhatIsHiddenIsNotMissing) {
  Draw draw(25);
  const Forest forest = tests::make_forest(180, draw);
  Mapped mapped(forest);
  auto scan = tests::scan_forest(forest, {}, {24, 0.0, 0, 0.05}, draw);
  std::sort(scan.begin(), scan.end(), [](const Point2& a, const Point2& b) { return a.y() < b.y(); });
  scan.resize(scan.size() / 2 + 2);  // to the right
  std::vector<float> free_m(360, 80.0F);
  std::fill(free_m.begin(), free_m.begin() + 180, 1.0F);  // a wall to the left
  const Evidence open = mapped.weigh_at(scan, {});
  mapped.view.free_m = free_m;
  const Evidence walled = mapped.weigh_at(scan, {});
  EXPECT_LT(walled.missing + 5, open.missing);
  EXPECT_GT(walled.ln_bayes, open.ln_bayes);
  EXPECT_GT(walled.log10_missing, open.log10_missing);
}

TEST(Evidence, WhileNothingWasLearnedTheSensorLooksAboutTheLandmarksOfTheScan) {
  Draw draw(27);
  const Forest forest = tests::make_forest(180, draw);
  Mapped mapped(forest);
  mapped.rates.bearings.fill(0.0F);
  auto scan = tests::scan_forest(forest, {}, {48, 0.0, 0, 0.05}, draw);
  const auto is_behind = [](const Point2& p) { return p.x() < 0.6 * p.norm(); };
  scan.erase(std::remove_if(scan.begin(), scan.end(), is_behind), scan.end());
  std::sort(scan.begin(), scan.end(), [](const Point2& a, const Point2& b) { return a.norm() > b.norm(); });
  const Evidence whole = mapped.weigh_at(scan, {});
  EXPECT_GE(whole.in_view, scan.size());
  EXPECT_LT(whole.in_view, 2 * scan.size()) << "what is behind was not looked at";
  scan.pop_back();
  EXPECT_EQ(mapped.weigh_at(scan, {}).missing, whole.missing + 1);
}

// A list may hold the heaviest few of all that stand there.
TEST(Evidence, OfASurveyTheShareThatAScanShowsIsNotKnown) {
  Draw draw(28);
  const Forest forest = tests::make_forest(180, draw);
  Mapped mapped(forest);
  const auto all = tests::scan_forest(forest, {}, {60, 0.0, 0, 0.05}, draw);
  std::vector<Point2> scan;
  for (std::size_t i = 3; i < all.size(); i += 4) {
    scan.push_back(all[i]);
  }
  const Evidence driven = mapped.weigh_at(scan, {});
  mapped.is_surveyed = true;
  const Evidence surveyed = mapped.weigh_at(scan, {});
  EXPECT_GT(driven.missing, 2 * driven.in_view / 3);
  EXPECT_EQ(surveyed.missing, driven.missing);
  EXPECT_GT(surveyed.ln_bayes, driven.ln_bayes + 5.0);
}

TEST(Evidence, LandmarksWithinTheSizeOfACopyAreOneGroup) {
  Draw draw(26);
  Forest copse{{}, 60.0};
  for (int i = 0; i < 12; ++i) {
    copse.trees_W.push_back({2.5 * (i % 4) - 4.0 + draw.normal(0.4), 2.5 * (i / 4) - 4.0 + draw.normal(0.4)});
  }
  Mapped one(copse);
  const auto scan = tests::scan_forest(copse, {}, {12, 0.0, 0, 0.02}, draw);
  EXPECT_NEAR(one.weigh_at(scan, {}).group_decades, 0.0, 1e-9);
  const Forest forest = tests::make_forest(180, draw);
  Mapped many(forest);
  const auto wide = tests::scan_forest(forest, {}, {40, 0.0, 0, 0.05}, draw);
  EXPECT_GT(many.weigh_at(wide, {}).group_decades, 2.0);
}

// A local map of two scans has confirmed what both of them showed: half of what the other map knows is no
// contradiction, a sixth of it is.
TEST(Evidence, AYoungMapHasConfirmedWhatTwoLooksShowed) {
  Draw draw(28);
  const Forest forest = tests::make_forest(120, draw);
  Mapped mapped(forest);
  mapped.rates.clutter_count = 200.0;  // experience, so that a contradiction counts
  constexpr MapSlot kYoung = 1;
  for (double x = -0.5 * forest.side_m; x < 0.5 * forest.side_m; x += ExploredGround::kCell_m) {
    for (double y = -0.5 * forest.side_m; y < 0.5 * forest.side_m; y += ExploredGround::kCell_m) {
      mapped.ground->look(kYoung, {x, y}, 0.6);
      mapped.ground->look(kYoung, {x, y}, 0.6);
    }
  }
  const auto weigh_every = [&](std::size_t step) {
    std::vector<Point2> confirmed;
    for (std::size_t i = 0; i < forest.trees_W.size(); i += step) {
      confirmed.push_back(forest.trees_W[i]);
    }
    Candidate candidate;
    return mapped.weigh_map(confirmed, kYoung, candidate);
  };
  EXPECT_LT(weigh_every(2).contradiction_decades(), 1.0);
  EXPECT_GT(weigh_every(6).contradiction_decades(), 2.0);
}

// A mower's scanner sees 10 m far: whatever it is shown lies within the usual size of a copy.
TEST(Evidence, ASensorOfShortReachHasSmallerGroups) {
  Draw draw(27);
  Forest garden = tests::make_forest(180, draw);
  for (Point2& tree : garden.trees_W) {
    tree *= 0.5;
  }
  garden.side_m *= 0.5;
  Mapped mapped(garden);
  const auto scan = tests::scan_forest(garden, {}, {18, 0.0, 0, 0.02}, draw);
  const Evidence unknown = mapped.weigh_at(scan, {});
  EXPECT_LE(unknown.group_decades, 1.0);
  EXPECT_EQ(unknown.small_group_decades, unknown.group_decades);
  mapped.sensor_reach_m = 10.0;
  const Evidence small = mapped.weigh_at(scan, {});
  EXPECT_EQ(small.group_decades, unknown.group_decades);
  EXPECT_GE(small.small_group_decades, unknown.group_decades + 1.0);
  mapped.sensor_reach_m = 20.0;  // from there on the usual size is the smaller
  EXPECT_EQ(mapped.weigh_at(scan, {}).small_group_decades, unknown.group_decades);
}

/// Trees of a known place whose thickness the map has from four sightings, and which a scan shows.
class Thickness : public testing::Test {
 protected:
  Thickness() : scan_(tests::scan_forest(forest_, {}, {24, 0.0, 0, 0.05}, draw_)) {
    for (std::size_t slot = 0; slot < forest_.trees_W.size(); ++slot) {
      trees_.push_back(draw_.normal(0.4));
      mapped_.standing[slot].size = {static_cast<float>(trees_[slot] + draw_.normal(kError / 2.0)), 4.0F};
    }
    mapped_.rates.size_count = 1000.0;
    mapped_.rates.size_square = kError * kError * mapped_.rates.size_count;
  }
  /// The scan's sizes, if its landmarks were the trees that `tree_of` names for those which they are.
  Evidence weigh_as(const std::function<std::size_t(std::uint32_t)>& tree_of) {
    mapped_.sizes.clear();
    for (const Point2& point : scan_) {
      double d2 = 0.0;
      const std::uint32_t slot = mapped_.index->nearest_within(0, point, 1.0, d2);
      mapped_.sizes.push_back(
          slot == LandmarkIndex::kNone
              ? LandmarkSize{}
              : LandmarkSize{static_cast<float>(trees_[tree_of(slot)] + draw_.normal(kError)), 1.0F});
    }
    return mapped_.weigh_at(scan_, {});
  }

  static constexpr double kError = 0.1;  // of a ln diameter
  Draw draw_{71};
  Forest forest_ = tests::make_forest(180, draw_);
  std::vector<double> trees_;  // ln diameters
  Mapped mapped_{forest_};
  std::vector<Point2> scan_;
};

TEST_F(Thickness, TheTreesThatStandThereSpeakForThePlace) {
  const Evidence evidence = weigh_as([](std::uint32_t slot) { return slot; });
  EXPECT_GT(evidence.ln_sizes, 10.0);
  EXPECT_GT(evidence.log10_odd_sizes, -1.0);
}

TEST_F(Thickness, OthersSpeakAgainstIt) {
  const Evidence evidence =
      weigh_as([&](std::uint32_t slot) { return (slot + 90) % forest_.trees_W.size(); });
  EXPECT_LT(evidence.ln_sizes, -5.0);
  EXPECT_LT(evidence.log10_odd_sizes, -1.0);
}

// The ratio of two likelihoods: where trees are others, its mean is 1, however often it is asked.
TEST_F(Thickness, OthersSeldomSpeakForIt) {
  double sum = 0.0;
  constexpr int kPlaces = 2000;
  for (int i = 0; i < kPlaces; ++i) {
    sum += std::exp(weigh_as([&](std::uint32_t) {
                      return draw_.below(static_cast<std::uint32_t>(trees_.size()));
                    }).ln_sizes);
  }
  EXPECT_LT(sum / kPlaces, 1.5);
}

TEST_F(Thickness, WhereAllAreAlikeItSaysNothing) {
  std::fill(trees_.begin(), trees_.end(), -1.0);
  for (Standing& standing : mapped_.standing) {
    standing.size = {-1.0F, 4.0F};
  }
  EXPECT_NEAR(weigh_as([](std::uint32_t slot) { return slot; }).ln_sizes, 0.0, 2.0);
}

// A detector whose widths are not the trees': the map says how much they differ from sighting to sighting.
TEST_F(Thickness, WhatIsMeasuredBadlySaysNothing) {
  mapped_.rates.size_square = 0.4 * mapped_.rates.size_count;
  EXPECT_EQ(weigh_as([](std::uint32_t slot) { return slot; }).ln_sizes, 0.0);
}

}  // namespace
}  // namespace slamsensor::core
