// Drives through worlds whose truth is known: each fix has to be right (AtlasRig).
#include "core/mapping/atlas.hpp"

#include "tests/unit/core/mapping/atlas_rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;
using tests::Forest;

TEST(Atlas, AForestDriveIsFixedAllTheWay) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    (void)rig.drive(forest, {-45, -10}, {45, 10}, draw);
    EXPECT_GE(rig.fixes, rig.scans - 2) << "seed " << seed;
    (void)rig.drive(forest, {45, 10}, {-45, -10}, draw);
    EXPECT_GE(rig.fixes, rig.scans - 3) << "seed " << seed;
    EXPECT_EQ(rig.wrong, 0);
  }
}

// All that a scan of 11 m reach shows lies within the usual size of a copy: 81 of 750 scans were a fix.
TEST(Atlas, AShortReachIsNoReasonForSilence) {
  int fixes = 0;
  int scans = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Draw draw(seed);
    Forest garden = tests::make_forest(300, draw);
    for (Point2& tree : garden.trees_W) {
      tree *= 0.55;
    }
    garden.side_m *= 0.55;
    AtlasRig rig;
    double x_m = 30.0;
    for (const double y_m : {-24.0, -12.0, 0.0, 12.0, 24.0}) {  // lane by lane
      (void)rig.drive(garden, {x_m, y_m}, {-x_m, y_m}, draw, 1.5, {18, 0.1, 1, 0.03});
      x_m = -x_m;
      (void)rig.drive(garden, {x_m, y_m}, {x_m, y_m + 12.0}, draw, 1.5, {18, 0.1, 1, 0.03});
    }
    fixes += rig.fixes;
    scans += rig.scans;
  }
  EXPECT_GE(fixes, scans / 2);
}

TEST(Atlas, PoorScansNeverGiveAWrongFix) {
  int fixes = 0;
  int scans = 0;
  for (std::uint64_t seed = 20; seed < 26; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    (void)rig.drive(forest, {-40, 0}, {40, 0}, draw, 2.0, {20, 0.3, 5, 0.15});
    fixes += rig.fixes;
    scans += rig.scans;
  }
  EXPECT_GE(fixes, scans / 5);
}

TEST(Atlas, APoorScanDoesNotBreakTheChain) {
  int fixes = 0;
  int scans = 0;
  for (std::uint64_t seed = 30; seed < 36; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(600, draw);
    AtlasRig rig;
    for (int i = 0; i < 60; ++i) {
      const Pose2 truth{1.5 * i - 45.0, 0.0, 0.3 * i};
      if (i % 4 == 3) {
        (void)rig.process({{3, 1}, {-4, 8}}, truth);  // walkers about the sensor hide the trees
      } else {
        (void)rig.look(forest, truth, draw, {16, 0.1, 1, 0.1});
        ++scans;
      }
    }
    fixes += rig.fixes;
  }
  EXPECT_GE(fixes, 2 * scans / 5);  // 76 of 270 where such a scan broke the chain
}

// As soon as a second scan shows it again, also where nothing is known yet of how far the world repeats
// itself.
TEST(Atlas, AFirstScanThatIsTooPoorForAFixFoundsTheHomeMapWithTheNext) {
  for (std::uint64_t seed = 40; seed < 46; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    EXPECT_EQ(rig.look(forest, {-30, 0, 0}, draw, {9, 0.0, 0, 0.05}).status, FixStatus::NoFix);
    EXPECT_GE(rig.drive(forest, {-29, 0}, {0, 0}, draw, 1.0), 27) << "seed " << seed;
  }
}

// Two copses of the same trees far from each other on open land, driven through one after the other without a
// kidnap: the second is not the first, whatever was seen last, and however long the first was looked at.
TEST(Atlas, ASecondCopseOfTheSameTreesIsNotTheFirst) {
  for (std::uint64_t seed = 50; seed < 62; ++seed) {
    Draw draw(seed);
    std::vector<Point2> copse;
    while (copse.size() < 12) {
      const Point2 p(draw.uniform(-10.0, 10.0), draw.uniform(-10.0, 10.0));
      if (std::all_of(copse.begin(), copse.end(), [&](const Point2& q) { return (p - q).norm() > 2.0; })) {
        copse.push_back(p);
      }
    }
    Forest world;
    for (const double x : {0.0, 120.0}) {
      for (const Point2& p : copse) {
        world.trees_W.push_back(p + Point2(x, 0.0));
      }
    }
    AtlasRig rig;
    for (int i = 0; i < 60; ++i) {
      const Pose2 truth{3.0 * i - 30.0 - (i > 20 && i < 40 ? 0.5 * (i - 20) : 0.0), 1.0, 0.1 * i};
      std::vector<Point2> scan;
      for (const Point2& p : world.trees_W) {
        if ((p - truth.translation()).norm() < 25.0 && draw.uniform(0.0, 1.0) > 0.1) {
          scan.push_back(truth.inverse() * p + Point2(draw.normal(0.05), draw.normal(0.05)));
        }
      }
      (void)rig.process(scan, truth);
    }
    EXPECT_EQ(rig.wrong, 0) << "seed " << seed;
  }
}

TEST(Atlas, APoorFirstScanBindsNothing) {
  Draw draw(2);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  // Seven landmarks that nothing ever shows again.
  EXPECT_EQ(rig.process({{3, 1}, {-4, 8}, {9, -6}, {-7, -3}, {1, 12}, {14, 2}, {-12, 5}}, {500, 0, 0}).status,
            FixStatus::NoFix);
  EXPECT_EQ(rig.atlas->home(), nullptr);
  EXPECT_GE(rig.drive(forest, {-30, 0}, {30, 0}, draw), 25);
  ASSERT_NE(rig.atlas->home(), nullptr);
  EXPECT_NE(rig.atlas->home()->number, 1U);
}

TEST(Atlas, ARichFirstScanIsTheOrigin) {
  Draw draw(3);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  const Fix fix = rig.look(forest, {4, 5, 1}, draw);
  EXPECT_EQ(fix.status, FixStatus::Fix);
  EXPECT_EQ(fix.pose_W.x_m, 0.0);
  EXPECT_EQ(fix.pose_W.heading_rad, 0.0);
  EXPECT_EQ(fix.map, 1U);
  EXPECT_EQ(fix.home, 1U);
}

// Home was founded by one rich scan of a place that is never seen again. Nothing of it was ever confirmed, so
// that the first map which three scans show takes its place.
TEST(Atlas, AHomeMapOfOneScanGivesWay) {
  Draw draw(4);
  const Forest gone = tests::make_forest(60, draw);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  EXPECT_EQ(rig.look(gone, {0, 0, 0}, draw).status, FixStatus::Fix);
  (void)rig.drive(forest, {-30, 0}, {30, 0}, draw);
  EXPECT_GE(rig.fixes, 27) << "of 32 scans";
  EXPECT_TRUE(rig.look(forest, {29, 0, 0.2}, draw).is_home_replaced)
      << "its datum is not that of the new one";
  EXPECT_EQ(rig.atlas->home()->number, 2U);
}

// Readings show the near face of a trunk. Until the drive itself has shown how far the centre lies behind it,
// the sensor expects what is usual; poses that took the faces for centres would drift.
TEST(Atlas, NearFacesOfTrunksDoNotBendAShortDrive) {
  ScanView view;
  view.shows_faces = true;
  for (const double radius_m : {0.0, 0.1, 0.2, 0.25}) {
    Draw draw(6);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    Pose2 origin;
    double square_m2 = 0.0;
    for (int i = 0; i < 14; ++i) {
      const Pose2 truth{-55.0 + 8.0 * i, 0.0, 0.4 * i};
      origin = i == 0 ? truth : origin;
      std::vector<Point2> scan = tests::scan_forest(forest, truth, {28, 0.1, 2, 0.03}, draw);
      for (Point2& p : scan) {
        p *= 1.0 - radius_m / p.norm();
      }
      const Fix fix = rig.process(scan, truth, view);
      ASSERT_EQ(fix.status, FixStatus::Fix) << "radius " << radius_m << " scan " << i;
      square_m2 += (origin * fix.pose_W.translation() - truth.translation()).squaredNorm();
    }
    EXPECT_LT(std::sqrt(square_m2 / 14.0), 0.14) << "radius " << radius_m;
  }
}

// The scan after the first is not believed, and begins a map. The third is explained by both maps, alike: the
// second map lies where its first scan said, and is no rival.
TEST(Atlas, AYoungMapIsNoRivalOfTheMapThatItBeganBeside) {
  int begun = 0;
  int fixed = 0;
  for (std::uint64_t seed = 20; seed < 60; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    (void)rig.look(forest, {0, 0, 0}, draw);
    (void)rig.look(forest, {16, 0, 0.4}, draw, {24, 0.3, 6, 0.05});
    if (rig.maps_in_use() == 2) {
      ++begun;
      fixed += rig.look(forest, {10, 3, 0.9}, draw).status == FixStatus::Fix ? 1 : 0;
    }
    EXPECT_EQ(rig.wrong, 0);
  }
  EXPECT_GE(begun, 5);
  EXPECT_GE(fixed, begun - 1);
}

TEST(Atlas, AKidnappedSensorFindsItselfAtOnce) {
  for (std::uint64_t seed = 5; seed < 9; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    AtlasRig rig;
    (void)rig.drive(forest, {-45, 0}, {45, 0}, draw);
    (void)rig.drive(forest, {45, 0}, {-45, 0}, draw);
    const int before = rig.fixes;
    for (int i = 0; i < 20; ++i) {
      (void)rig.look(forest, {draw.uniform(-40, 40), draw.uniform(-3, 3), draw.uniform(-3, 3)}, draw);
    }
    EXPECT_GE(rig.fixes - before, 18) << "seed " << seed;
  }
}

TEST(Atlas, InAForeignForestThereIsNoFix) {
  for (std::uint64_t seed = 30; seed < 34; ++seed) {
    Draw draw(seed);
    const Forest forest = tests::make_forest(250, draw);
    const Forest elsewhere = tests::make_forest(250, draw);
    AtlasRig rig;
    (void)rig.drive(forest, {-30, 0}, {30, 0}, draw);
    const int before = rig.fixes;
    for (int i = 0; i < 20; ++i) {
      const Fix fix = rig.look(elsewhere, {draw.uniform(-30, 30), draw.uniform(-30, 30), 0.0}, draw);
      EXPECT_TRUE(fix.status == FixStatus::NoFix || fix.reason == FixReason::Symmetric);
    }
    EXPECT_EQ(rig.fixes, before);
    EXPECT_EQ(rig.look(forest, {0, 0, 1}, draw).status, FixStatus::Fix);
  }
}

/// Trees or stands of a copse about its middle, and where its twin stands.
Forest make_twins(const std::vector<Point2>& one, const Pose2& T_twin, int twins) {
  Forest world;
  for (int twin = 0; twin < twins; ++twin) {
    for (const Point2& p : one) {
      world.trees_W.push_back(twin == 0 ? p : T_twin * p);
    }
  }
  return world;
}

// The twin was never mapped. Whatever is seen of it, it is never taken for the copse that was.
TEST(Atlas, ATwinCopseOrStandIsNeverTakenForTheOther) {
  Draw draw(10);
  std::vector<Point2> copse;
  for (int i = 0; i < 12; ++i) {
    copse.push_back({3.0 * (i % 4) - 4.5 + draw.normal(0.5), 3.0 * (i / 4) - 3.0 + draw.normal(0.5)});
  }
  std::vector<Point2> stand;  // of bicycles
  for (int i = 0; i < 14; ++i) {
    stand.push_back({1.1 * (i / 2) - 3.5, i % 2 == 0 ? 0.0 : 1.8});
  }
  for (const std::vector<Point2>& thing : {copse, stand}) {
    const Forest world = make_twins(thing, {300.0, 40.0, 1.1}, 2);
    AtlasRig rig;
    const auto seen = static_cast<std::uint32_t>(thing.size());
    for (int i = 0; i < 15; ++i) {
      (void)rig.look(world, {0.5 * i - 4.0, -9.0, 0.2 * i}, draw, {seen, 0.05, 1, 0.03});
    }
    const int before = rig.fixes;
    for (int i = 0; i < 25; ++i) {
      const Pose2 at_twin = Pose2{300.0, 40.0, 1.1} * Pose2{0.5 * i - 6.0, -9.0, 0.2 * i};
      const Fix fix = rig.atlas->process(
          tests::as_landmarks(tests::scan_forest(world, at_twin, {seen, 0.05, 1, 0.03}, draw)), {}, {});
      EXPECT_NE(fix.status, FixStatus::Fix) << "scan " << i << " of " << seen;
    }
    EXPECT_EQ(rig.fixes, before);
  }
}

// Two copses that are alike stand in a forest and were mapped both: the trees about them tell them apart.
TEST(Atlas, TwinsInAForestAreToldApart) {
  Draw draw(11);
  Forest forest = tests::make_forest(250, draw);
  std::vector<Point2> copse;
  for (int i = 0; i < 10; ++i) {
    copse.push_back({draw.uniform(-4, 4), draw.uniform(-4, 4)});
  }
  for (const Pose2& T : {Pose2{-25, 12, 0.0}, Pose2{25, 12, 1.0}}) {
    for (const Point2& p : copse) {
      forest.trees_W.push_back(T * p);
    }
  }
  AtlasRig rig;
  (void)rig.drive(forest, {-45, 0}, {45, 0}, draw, 2.0, {34, 0.1, 2, 0.05});
  for (int i = 0; i < 20; ++i) {
    (void)rig.look(forest, {(i % 2 == 0 ? -25.0 : 25.0) + draw.uniform(-3, 3), draw.uniform(-2, 2), 0.4 * i},
                   draw, {34, 0.1, 2, 0.05});
  }
  EXPECT_GE(rig.fixes, rig.scans - 6);
}

// A search that the deadline cut does not say that the place is unknown: no copy of it is begun.
TEST(Atlas, ASearchThatWasCutStartsNoMap) {
  Draw draw(12);
  const Forest forest = tests::make_forest(250, draw);
  AtlasRig rig;
  (void)rig.drive(forest, {-10, 0}, {10, 0}, draw);
  const std::uint32_t maps = rig.maps_in_use();
  const Deadline expired{[](void*) noexcept { return std::chrono::nanoseconds(1); }, nullptr,
                         std::chrono::nanoseconds(1)};
  for (int i = 0; i < 3; ++i) {
    const Fix fix =
        rig.process(tests::scan_forest(forest, {0, 0, 1.0 * i}, kClear, draw), {0, 0, 1.0 * i}, {}, expired);
    EXPECT_EQ(fix.status, FixStatus::NoFix);
    EXPECT_EQ(fix.reason, FixReason::Deadline);
    EXPECT_EQ(fix.search_end, SearchEnd::Deadline);
  }
  EXPECT_EQ(rig.maps_in_use(), maps);
  EXPECT_EQ(rig.atlas->counters().searches_cut, 3U);
  EXPECT_EQ(rig.look(forest, {0, 0, 2}, draw).status, FixStatus::Fix);
}

TEST(Atlas, LandmarksThatAreNoPlacesAreRefusedAndCounted) {
  AtlasRig rig;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Fix fix =
      rig.process({Point2(1, 1), Point2(nan, 2), Point2(5, 2), Point2(3, 1e9), Point2(-4, 3)}, {});
  EXPECT_EQ(fix.landmarks_seen, 3U);
  EXPECT_EQ(rig.atlas->counters().landmarks_refused, 2U);
}

TEST(Atlas, TooFewLandmarksAreSaidSoAndChangeNothing) {
  AtlasRig rig;
  const Fix fix = rig.process({Point2(1, 1), Point2(5, 2)}, {});
  EXPECT_EQ(fix.status, FixStatus::NoFix);
  EXPECT_EQ(fix.reason, FixReason::TooFewLandmarks);
  EXPECT_EQ(rig.maps_in_use(), 0U);
  EXPECT_EQ(rig.atlas->revision(), 0U);
}

TEST(Atlas, TheMountCarriesScansToTheBody) {
  Draw draw(9);
  const Forest forest = tests::make_forest(60, draw);
  Config config = atlas_config();
  config.mount = {3.0, 0.5, 0.2};
  const Pose2 T_B_L{3.0, 0.5, 0.2};
  AtlasRig rig(config);
  // The body turns on the spot: its own pose does not move although the sensor swings around it.
  for (int i = 0; i < 8; ++i) {
    const Pose2 T_W_B{0.0, 0.0, 0.8 * i};
    const Fix fix = rig.process(tests::scan_forest(forest, T_W_B * T_B_L, {30, 0.0, 0, 0.0}, draw), T_W_B);
    ASSERT_EQ(fix.status, FixStatus::Fix);
    EXPECT_NEAR(fix.pose_W.translation().norm(), 0.0, 1e-4) << "turn " << i;
    EXPECT_NEAR(wrap_angle(fix.pose_W.heading_rad - 0.8 * i), 0.0, 1e-5);
  }
}

TEST(Atlas, TheSameScansGiveTheSameFixesAlsoAfterAReset) {
  Draw draw(11);
  const Forest forest = tests::make_forest(200, draw);
  std::vector<std::vector<ScanLandmark>> walk;
  for (int i = 0; i < 40; ++i) {
    walk.push_back(
        tests::as_landmarks(tests::scan_forest(forest, {1.5 * i - 30.0, 0, 0.1 * i}, kClear, draw)));
  }
  const auto run = [&](Atlas& atlas) {
    std::vector<double> numbers;
    for (const auto& scan : walk) {
      const Fix fix = atlas.process(scan, {}, {});
      numbers.insert(numbers.end(),
                     {fix.pose_W.x_m, fix.pose_W.heading_rad, fix.expected_false_alarms, fix.covariance(0, 0),
                      static_cast<double>(fix.landmarks_in_map), static_cast<double>(fix.scan)});
    }
    return numbers;
  };
  AtlasRig one;
  AtlasRig other;
  const std::vector<double> first = run(*one.atlas);
  EXPECT_EQ(first, run(*other.atlas));
  one.atlas->reset();
  EXPECT_EQ(one.atlas->home(), nullptr);
  EXPECT_EQ(first, run(*one.atlas));
}

}  // namespace
}  // namespace slamsensor::core
