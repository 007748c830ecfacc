#include "core/mapping/sighting_graph.hpp"

#include "tests/unit/core/mapping/graph_rig.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;

/// A world of landmarks of two maps, and what poses see of it with errors.
struct World {
  MirroredGraph mirror;
  Draw draw;
  std::vector<std::uint32_t> slots[2];

  World(const Config& config, std::uint64_t seed) : mirror(config), draw(seed) {
    for (int i = 0; i < 80; ++i) {
      for (MapSlot map = 0; map < 2; ++map) {
        slots[map].push_back(mirror.add_landmark(map, {draw.uniform(-30, 30), draw.uniform(-30, 30)}));
      }
    }
  }
  std::uint32_t look(MapSlot map, double error_m, bool is_anchor = false) {
    const Pose2 T_W_B{draw.uniform(-20, 20), draw.uniform(-20, 20), draw.uniform(-3, 3)};
    const Pose2 T_L_W = Pose2{0.5, -0.2, 0.3}.inverse() * T_W_B.inverse();
    std::vector<SightingGraph::Seen> seen;
    for (const std::uint32_t slot : slots[map]) {
      if (seen.size() < 30 && draw.below(3) == 0) {
        const Point2 p_W =
            mirror.graph->positions()[slot] + Point2(draw.normal(error_m), draw.normal(error_m));
        seen.push_back({slot, T_L_W * p_W});
      }
    }
    return mirror.add_pose(map, T_W_B, seen, is_anchor);
  }
};

TEST(SightingGraph, LandmarksStandAtTheMeanOfWhatWasSeenAfterAnyChanges) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    World world(graph_config(40, 700), seed);
    for (int i = 0; i < 300; ++i) {
      const auto map = static_cast<MapSlot>(world.draw.below(2));
      const std::vector<std::uint32_t> places = world.mirror.places();
      const std::uint32_t what = world.draw.below(10);
      if (places.empty() || what < 5) {
        (void)world.look(map, 0.1);
      } else if (what < 8) {
        world.mirror.graph->refit(places[world.draw.below(static_cast<std::uint32_t>(places.size()))]);
      } else if (what == 8 && world.slots[map].size() > 40) {
        const std::size_t at = world.draw.below(static_cast<std::uint32_t>(world.slots[map].size()));
        world.mirror.remove_landmark(world.slots[map][at]);
        world.slots[map].erase(world.slots[map].begin() + static_cast<std::ptrdiff_t>(at));
      } else if (i % 7 == 0) {
        world.mirror.graph->refit_in_turn(100);
      }
      if (i % 10 == 0) {
        world.mirror.expect_means();
      }
    }
    EXPECT_GT(world.mirror.graph->poses_folded(), 20U);
    world.mirror.expect_means();
  }
}

TEST(SightingGraph, ARemovedPoseHasSaidNothing) {
  World world(graph_config(60, 2'000), 4);
  for (int i = 0; i < 40; ++i) {
    (void)world.look(static_cast<MapSlot>(i % 2), 0.1);
  }
  for (int i = 0; i < 20; ++i) {
    const std::vector<std::uint32_t> places = world.mirror.places();
    world.mirror.remove_pose(places[world.draw.below(static_cast<std::uint32_t>(places.size()))]);
    if (i < 15) {
      world.mirror.expect_means();
    }
  }
}

TEST(SightingGraph, MergedMapsAreOne) {
  World world(graph_config(20, 2'000), 5);
  for (int i = 0; i < 30; ++i) {  // some poses are folded before, some stay
    (void)world.look(static_cast<MapSlot>(i % 2), 0.1);
  }
  std::vector<Match> twins;
  for (std::uint32_t i = 0; i < 10; ++i) {
    twins.push_back({world.slots[1][i], world.slots[0][i]});
  }
  const Standing one = world.mirror.graph->standing(world.slots[0][3]);
  const Standing other = world.mirror.graph->standing(world.slots[1][3]);
  world.mirror.merge(1, 0, {50.0, -20.0, 1.2}, twins);
  world.mirror.expect_means();
  for (std::uint32_t i = 0; i < 80; ++i) {
    EXPECT_EQ(world.mirror.graph->is_used(world.slots[1][i]), i >= 10);
    EXPECT_TRUE(world.mirror.graph->is_used(world.slots[0][i]));
    EXPECT_TRUE(i < 10 || world.mirror.graph->landmark(world.slots[1][i]).map == 0);
  }
  EXPECT_EQ(world.mirror.graph->standing(world.slots[0][3]).sightings, one.sightings + other.sightings);
  world.mirror.graph->visit_poses([](std::uint32_t, const GraphPose& pose) { EXPECT_EQ(pose.map, 0); });
  for (int i = 0; i < 30; ++i) {
    (void)world.look(0, 0.1);
  }
  world.mirror.expect_means();
}

TEST(SightingGraph, AFoldLeavesLandmarksWhereTheyAre) {
  World world(graph_config(30, 2'000), 6);
  for (int i = 0; i < 30; ++i) {
    (void)world.look(0, 0.1);
  }
  const std::vector<Point2> before(world.mirror.graph->positions().begin(),
                                   world.mirror.graph->positions().end());
  GraphPose far;  // sees nothing that is there
  far.map = 1;
  for (int i = 0; i < 25; ++i) {
    far.scan = static_cast<std::uint32_t>(100 + i);
    (void)world.mirror.graph->add_pose(far,
                                       std::vector<SightingGraph::Seen>{{world.slots[1][0], {1.0, 1.0}}});
  }
  EXPECT_EQ(world.mirror.graph->poses_folded(), 25U);
  for (const std::uint32_t slot : world.slots[0]) {
    EXPECT_LT((world.mirror.graph->positions()[slot] - before[slot]).norm(), 1e-4);
  }
}

TEST(SightingGraph, ARefitLowersTheCost) {
  for (std::uint64_t seed = 10; seed < 15; ++seed) {
    World world(graph_config(60, 2'000), seed);
    (void)world.look(0, 0.1, true);
    for (int i = 0; i < 40; ++i) {
      (void)world.look(0, 0.3);
    }
    double before = world.mirror.cost();
    for (const std::uint32_t place : world.mirror.places()) {
      world.mirror.graph->refit(place);
      const double after = world.mirror.cost();
      EXPECT_LE(after, before * (1.0 + 1e-6));
      before = after;
    }
    world.mirror.expect_means();
  }
}

// Landmarks that were taken out leave poses behind that one or two others hold; those would turn about them
// at will.
TEST(SightingGraph, APoseThatHardlyAnythingHoldsStays) {
  MirroredGraph mirror(graph_config(20, 200));
  std::vector<SightingGraph::Seen> seen;
  for (int i = 0; i < 6; ++i) {
    const Point2 p(5.0 + i, i % 2 == 0 ? 3.0 : -2.0);
    seen.push_back({mirror.add_landmark(0, mirror.graph->body_point(p)), p});
  }
  (void)mirror.add_pose(0, Pose2{}, seen, true);
  for (SightingGraph::Seen& s : seen) {
    s.point_L += Point2(0.1, -0.05);
  }
  const std::uint32_t place = mirror.add_pose(0, {0.02, 0.01, 0.01}, seen);
  for (std::size_t i = 2; i < seen.size(); ++i) {
    mirror.remove_landmark(seen[i].landmark);
  }
  mirror.graph->refit(place);
  EXPECT_EQ(mirror.graph->pose(place).T_W_B.heading_rad, 0.01);
  EXPECT_EQ(mirror.graph->pose(place).T_W_B.x_m, 0.02);
}

// A tree that was felled still says how the poses lie that saw it. When it was forgotten with its sightings,
// nothing held those poses, and whole maps turned.
TEST(SightingGraph, ARetiredLandmarkIsMatchedNoMoreAndHoldsItsPosesAsBefore) {
  World world(graph_config(60, 2'000), 21);
  World twin(graph_config(60, 2'000), 21);
  std::vector<std::uint32_t> places;
  for (World* w : {&world, &twin}) {
    places.clear();
    places.push_back(w->look(0, 0.1, true));
    for (int i = 0; i < 20; ++i) {
      places.push_back(w->look(0, 0.2));
    }
  }
  SightingGraph& graph = *world.mirror.graph;
  for (std::uint32_t i = 0; i < 60; ++i) {
    graph.retire_landmark(world.slots[0][i]);
    EXPECT_FALSE(graph.is_used(world.slots[0][i]));
  }
  EXPECT_EQ(graph.index().size(), 100U);
  for (const std::uint32_t place : places) {
    graph.refit(place);
    twin.mirror.graph->refit(place);
    EXPECT_EQ(graph.pose(place).T_W_B.x_m, twin.mirror.graph->pose(place).T_W_B.x_m);
  }
  EXPECT_EQ(graph.free_landmarks(), twin.mirror.graph->free_landmarks() + 60);
}

TEST(SightingGraph, TheSlotOfARetiredLandmarkIsThereForAnother) {
  World world(graph_config(60, 2'000), 22);
  for (int i = 0; i < 10; ++i) {
    (void)world.look(0, 0.1);
  }
  SightingGraph& graph = *world.mirror.graph;
  while (graph.free_landmarks() > 0) {
    (void)world.mirror.add_landmark(1, {world.draw.uniform(-30, 30), world.draw.uniform(-30, 30)});
  }
  graph.retire_landmark(world.slots[0][0]);
  graph.retire_landmark(world.slots[0][1]);
  EXPECT_EQ(graph.free_landmarks(), 2U);
  EXPECT_NE(graph.add_landmark(0, {1.0, 2.0}, 50, 0), SightingGraph::kNone);
  EXPECT_NE(graph.add_landmark(0, {3.0, 4.0}, 50, 0), SightingGraph::kNone);
  EXPECT_EQ(graph.free_landmarks(), 0U);
  EXPECT_EQ(graph.add_landmark(0, {5.0, 6.0}, 50, 0), SightingGraph::kNone);
}

TEST(SightingGraph, ARetiredLandmarkGoesWithItsLastSighting) {
  World world(graph_config(12, 2'000), 23);
  (void)world.look(0, 0.1);
  SightingGraph& graph = *world.mirror.graph;
  const std::uint32_t free_before = graph.free_landmarks();
  graph.retire_landmark(world.slots[0][0]);
  world.slots[0].erase(world.slots[0].begin());
  for (int i = 0; i < 40; ++i) {
    (void)world.look(0, 0.1);  // the first pose is folded
  }
  EXPECT_EQ(graph.free_landmarks(), free_before + 1);
  graph.forget(0);
  EXPECT_EQ(graph.free_landmarks(), free_before + 80);
}

TEST(SightingGraph, WhatOneScanShowsTwiceIsNotOne) {
  MirroredGraph mirror(graph_config(20, 200));
  std::vector<std::uint32_t> slots;
  for (int i = 0; i < 4; ++i) {
    slots.push_back(mirror.add_landmark(0, Point2(4.0 * i, 1.0)));
  }
  (void)mirror.add_pose(0, Pose2{}, {{slots[0], {0.0, 1.0}}, {slots[1], {4.0, 1.0}}}, true);
  (void)mirror.add_pose(0, Pose2{}, {{slots[1], {4.0, 1.0}}, {slots[2], {8.0, 1.0}}});
  EXPECT_FALSE(mirror.graph->may_be_one(slots[0], slots[1]));
  EXPECT_FALSE(mirror.graph->may_be_one(slots[2], slots[1]));
  EXPECT_TRUE(mirror.graph->may_be_one(slots[0], slots[2]));
  EXPECT_EQ(mirror.graph->scans_of_both(std::vector{slots[0], slots[2]}, std::vector{slots[1]}, 1), 2U);
  EXPECT_EQ(mirror.graph->scans_of_both(std::vector{slots[0]}, std::vector{slots[2], slots[3]}, 1), 0U);
  (void)mirror.add_pose(0, Pose2{}, {{slots[0], {0.0, 1.0}}, {slots[1], {4.0, 1.0}}, {slots[2], {8.0, 1.0}}});
  const std::vector some{slots[0], slots[1]};
  const std::vector others{slots[2], slots[3]};
  EXPECT_EQ(mirror.graph->scans_of_both(some, others, 1), 2U);
  EXPECT_EQ(mirror.graph->scans_of_both(some, others, 2), 0U) << "one landmark of the others";
  (void)mirror.add_pose(
      0, Pose2{},
      {{slots[0], {0.0, 1.0}}, {slots[1], {4.0, 1.0}}, {slots[2], {8.0, 1.0}}, {slots[3], {12.0, 1.0}}});
  EXPECT_EQ(mirror.graph->scans_of_both(some, others, 2), 1U);
  EXPECT_EQ(mirror.graph->scans_of_both(others, some, 2), 1U);
  mirror.graph->set_prior(slots[0], 3.0);
  mirror.graph->set_prior(slots[2], 3.0);
  EXPECT_FALSE(mirror.graph->may_be_one(slots[0], slots[2])) << "both come from before what is kept";
}

TEST(SightingGraph, AnAnchorStays) {
  World world(graph_config(60, 2'000), 7);
  const std::uint32_t anchor = world.look(0, 0.2, true);
  const Pose2 before = world.mirror.graph->pose(anchor).T_W_B;
  for (int i = 0; i < 10; ++i) {
    world.mirror.graph->refit_around(world.look(0, 0.2), 16);
  }
  world.mirror.graph->refit(anchor);
  EXPECT_EQ(world.mirror.graph->pose(anchor).T_W_B.x_m, before.x_m);
  EXPECT_EQ(world.mirror.graph->pose(anchor).T_W_B.heading_rad, before.heading_rad);
}

TEST(SightingGraph, AForgottenMapLeavesTheOtherAlone) {
  World world(graph_config(40, 2'000), 8);
  for (int i = 0; i < 20; ++i) {
    (void)world.look(static_cast<MapSlot>(i % 2), 0.1);
  }
  const std::vector<Point2> before(world.mirror.graph->positions().begin(),
                                   world.mirror.graph->positions().end());
  world.mirror.graph->forget(1);
  for (std::uint32_t i = 0; i < 80; ++i) {
    EXPECT_FALSE(world.mirror.graph->is_used(world.slots[1][i]));
    EXPECT_TRUE(world.mirror.graph->is_used(world.slots[0][i]));
    EXPECT_EQ(world.mirror.graph->positions()[world.slots[0][i]], before[world.slots[0][i]]);
  }
  world.mirror.graph->visit_poses([](std::uint32_t, const GraphPose& pose) { EXPECT_EQ(pose.map, 0); });
  EXPECT_EQ(world.mirror.graph->index().size(), 80U);
  EXPECT_EQ(world.mirror.graph->free_landmarks(), 300U - 80U);
}

}  // namespace
}  // namespace slamsensor::core
