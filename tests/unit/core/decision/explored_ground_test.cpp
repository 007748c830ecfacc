#include "core/decision/explored_ground.hpp"

#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

namespace slamsensor::core {
namespace {

Capacities small_capacities() {
  Capacities c;
  c.map_landmarks = 1'000;
  return c;
}

TEST(ExploredGround, RemembersEachLookAndNothingElse) {
  tests::Draw draw(1);
  tests::InArena<ExploredGround> ground(small_capacities());
  std::map<std::tuple<int, int, int>, double> missed;  // chance that no look would have shown a landmark
  for (int i = 0; i < 3'000; ++i) {
    const int map = static_cast<int>(draw.below(3));
    const Point2 p{draw.uniform(-60.0, 60.0), draw.uniform(-60.0, 60.0)};
    const double detection = draw.uniform(0.1, 0.9);
    ground->look(static_cast<MapSlot>(map), p, detection);
    const auto cell = [](double v) { return static_cast<int>(std::floor(v / ExploredGround::kCell_m)); };
    const auto [entry, is_new] = missed.try_emplace({map, cell(p.x()), cell(p.y())}, 1.0);
    entry->second *= 1.0 - detection;
  }
  EXPECT_EQ(ground->cells_dropped(), 0U);
  EXPECT_NEAR(ground->area_m2(), 16.0 * static_cast<double>(missed.size()), 1e-9);
  for (int map = 0; map < 4; ++map) {
    for (int x = -20; x < 20; ++x) {
      for (int y = -20; y < 20; ++y) {
        const auto found = missed.find({map, x, y});
        const double expected = found == missed.end() ? 0.0 : 1.0 - found->second;
        const double explored = ground->explored(static_cast<MapSlot>(map), {4.0 * x + 1.0, 4.0 * y + 3.0});
        EXPECT_EQ(explored == 0.0, expected == 0.0);
        EXPECT_NEAR(explored, expected, 0.12);  // each look is rounded up to a sixteenth
        EXPECT_GE(explored, expected - 1e-6);
        EXPECT_LT(explored, 1.0);
      }
    }
  }
}

TEST(ExploredGround, AForgottenMapIsNewGroundAndLeavesRoomForOthers) {
  tests::Draw draw(2);
  tests::InArena<ExploredGround> ground(small_capacities());
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < 1'500; ++i) {
      ground->look(static_cast<MapSlot>(round % 2), {draw.uniform(-90.0, 90.0), draw.uniform(-90.0, 90.0)},
                   0.5);
    }
    ground->look(7, {1.0, 1.0}, 0.5);
    ground->forget(static_cast<MapSlot>(round % 2));
    EXPECT_EQ(ground->area_m2(), 16.0);
    EXPECT_EQ(ground->explored(static_cast<MapSlot>(round % 2), {1.0, 1.0}), 0.0);
    EXPECT_GT(ground->explored(7, {1.0, 1.0}), 0.0);
  }
  EXPECT_EQ(ground->cells_dropped(), 0U);
  ground->clear();
  EXPECT_EQ(ground->area_m2(), 0.0);
  EXPECT_EQ(ground->explored(7, {1.0, 1.0}), 0.0);
}

// The number by which a map's ground is told from what was forgotten comes round again.
TEST(ExploredGround, WhatWasForgottenLongAgoDoesNotComeBack) {
  tests::InArena<ExploredGround> ground(small_capacities());
  for (int round = 0; round < 5'000; ++round) {
    const Point2 p{4.0 * (round % 900), 1.0};
    EXPECT_EQ(ground->explored(3, p), 0.0);
    ground->look(3, p, 0.5);
    ground->look(5, {1.0, 1.0}, 0.01);
    EXPECT_EQ(ground->area_m2(), 32.0);
    ground->forget(3);
    EXPECT_EQ(ground->area_m2(), 16.0);
  }
  EXPECT_EQ(ground->cells_dropped(), 0U);
}

TEST(ExploredGround, AFullTableCountsWhatItLeavesOut) {
  Capacities c;
  c.map_landmarks = 3;
  tests::InArena<ExploredGround> ground(c);
  for (int i = 0; i < 3'000; ++i) {
    ground->look(0, {4.0 * i, 0.0}, 0.5);
  }
  EXPECT_GT(ground->cells_dropped(), 1'000U);
  EXPECT_NEAR(ground->area_m2(), 16.0 * (3'000.0 - static_cast<double>(ground->cells_dropped())), 1e-9);
}

TEST(ExploredGround, LooksSaturate) {
  tests::InArena<ExploredGround> ground(small_capacities());
  for (int i = 0; i < 10'000; ++i) {
    ground->look(0, {1.0, 1.0}, 0.97);
  }
  EXPECT_GT(ground->explored(0, {1.0, 1.0}), 0.999);
  EXPECT_LT(ground->explored(0, {1.0, 1.0}), 1.0);
}

}  // namespace
}  // namespace slamsensor::core
