#include "core/association/landmark_index.hpp"

#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;

constexpr std::uint32_t kSlots = 300;

Capacities small_capacities() {
  Capacities c;
  c.map_landmarks = kSlots;
  return c;
}

/// The index and what it should hold.
struct Mirrored {
  AssociationConfig config;
  tests::InArena<LandmarkIndex> index{config, small_capacities()};
  std::vector<std::optional<std::pair<MapSlot, Point2>>> listed =
      std::vector<std::optional<std::pair<MapSlot, Point2>>>(kSlots);

  void insert(std::uint32_t slot, MapSlot map, const Point2& p) {
    index->insert(slot, map, p);
    listed[slot] = {map, p};
  }
  void move(std::uint32_t slot, const Point2& p) {
    index->move(slot, p);
    listed[slot]->second = p;
  }
  void erase(std::uint32_t slot) {
    index->erase(slot);
    listed[slot].reset();
  }
  /// One random change in a world of `side_m`.
  void change(Draw& draw, double side_m) {
    const std::uint32_t slot = draw.below(kSlots);
    const Point2 p{draw.uniform(-side_m, side_m), draw.uniform(-side_m, side_m)};
    if (!listed[slot]) {
      insert(slot, static_cast<MapSlot>(draw.below(3)), p);
    } else if (draw.below(3) == 0) {
      erase(slot);
    } else if (draw.below(2) == 0) {
      move(slot, p);
    } else {
      move(slot, listed[slot]->second + Point2(draw.normal(0.1), draw.normal(0.1)));
    }
  }
  [[nodiscard]] double side_min_m() const { return std::min(2.0 * config.tolerance_m, 2.0); }
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(
        std::count_if(listed.begin(), listed.end(), [](const auto& l) { return l.has_value(); }));
  }
};

TEST(LandmarkIndex, LookUpsByPlaceEqualBruteForceAfterAnyChanges) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Draw draw(seed);
    Mirrored m;
    const double side_m = seed % 2 == 0 ? 20.0 : 200.0;
    for (int i = 0; i < 6'000; ++i) {
      m.change(draw, side_m);
      if (i % 10 != 0) {
        continue;
      }
      const auto map = static_cast<MapSlot>(draw.below(3));
      const Point2 at{draw.uniform(-side_m, side_m), draw.uniform(-side_m, side_m)};
      const double radius_m = draw.uniform(0.1, 0.4 * side_m);
      std::map<std::uint32_t, int> visits;
      m.index->visit_within(map, at, radius_m, [&](std::uint32_t slot, double d2) {
        ++visits[slot];
        EXPECT_NEAR(d2, (m.listed[slot]->second - at).squaredNorm(), 1e-2);
      });
      double nearest_m = radius_m;
      for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
        const bool is_there = m.listed[slot] && m.listed[slot]->first == map;
        const double distance_m = is_there ? (m.listed[slot]->second - at).norm() : 1e9;
        nearest_m = std::min(nearest_m, distance_m);
        if (std::abs(distance_m - radius_m) > 1e-3) {  // places are kept to about 1e-5 m
          EXPECT_EQ(visits.count(slot) == 1 && visits[slot] == 1, distance_m < radius_m) << "slot " << slot;
        }
      }
      double d2 = 0.0;
      const std::uint32_t nearest = m.index->nearest_within(map, at, radius_m, d2);
      if (nearest_m < radius_m - 1e-3) {
        ASSERT_NE(nearest, LandmarkIndex::kNone);
        EXPECT_NEAR(std::sqrt(d2), nearest_m, 1e-3);
        EXPECT_NEAR((m.listed[nearest]->second - at).norm(), nearest_m, 1e-3);
      }
    }
    EXPECT_EQ(m.index->size(), m.count());
    EXPECT_EQ(m.index->triangles_dropped(), 0U);
  }
}

/// The nearest landmarks of the same map that may be linked to `slot`.
std::vector<std::uint32_t> neighbours(const Mirrored& m, std::uint32_t slot) {
  std::vector<std::pair<double, std::uint32_t>> near;
  for (std::uint32_t other = 0; other < kSlots; ++other) {
    if (other == slot || !m.listed[other] || m.listed[other]->first != m.listed[slot]->first) {
      continue;
    }
    const double distance_m = (m.listed[other]->second - m.listed[slot]->second).norm();
    if (distance_m > m.side_min_m() && distance_m < LandmarkIndex::kLinkRange_m) {
      near.emplace_back(distance_m, other);
    }
  }
  std::sort(near.begin(), near.end());
  near.resize(std::min<std::size_t>(near.size(), m.config.index_neighbours));
  std::vector<std::uint32_t> slots;
  for (const auto& [distance_m, other] : near) {
    slots.push_back(other);
  }
  return slots;
}

struct Found {
  int asked = 0;
  int found = 0;
};

/// Asks for each triangle of each landmark with two of its nearest neighbours as a scan would show it.
Found ask_for_triangles(Mirrored& m, Draw& draw) {
  Found result;
  for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
    if (!m.listed[slot]) {
      continue;
    }
    const auto near = neighbours(m, slot);
    for (std::size_t i = 0; i < near.size(); ++i) {
      for (std::size_t j = i + 1; j < near.size(); ++j) {
        const Point2 a = m.listed[slot]->second;
        const Point2 b = m.listed[near[j]]->second;  // the farther one
        const Point2 c = m.listed[near[i]]->second;
        LandmarkIndex::Sides sides;
        sides.longest_m = static_cast<float>((b - c).norm() + draw.uniform(-0.2, 0.2));
        sides.middle_m = static_cast<float>((b - a).norm() + draw.uniform(-0.2, 0.2));
        sides.shortest_m = static_cast<float>((c - a).norm() + draw.uniform(-0.2, 0.2));
        if ((b - c).norm() < (b - a).norm() + 1e-3 || (b - a).norm() < (c - a).norm() + 0.3) {
          continue;  // another corner is the apex, or which corner comes second is a matter of rounding
        }
        const double turn = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
        bool is_found = false;
        int turned_over = 0;
        m.index->visit_triangles(
            sides, 0.3F + 0.25F,
            turn > 0.0 ? LandmarkIndex::Turn::CounterClockwise : LandmarkIndex::Turn::Clockwise,
            [&](std::uint32_t apex, std::uint32_t second, std::uint32_t third) {
              is_found = is_found || (apex == slot && second == near[j] && third == near[i]);
            });
        m.index->visit_triangles(
            sides, 0.55F, turn > 0.0 ? LandmarkIndex::Turn::Clockwise : LandmarkIndex::Turn::CounterClockwise,
            [&](std::uint32_t apex, std::uint32_t second, std::uint32_t third) {
              turned_over += apex == slot && second == near[j] && third == near[i] ? 1 : 0;
            });
        EXPECT_TRUE(turned_over == 0 || std::abs(turn) < 0.5 * (b - c).norm());
        ++result.asked;
        result.found += is_found ? 1 : 0;
      }
    }
  }
  return result;
}

TEST(LandmarkIndex, CongruentTrianglesAreFound) {
  for (const double side_m : {40.0, 120.0}) {
    Draw draw(7);
    Mirrored m;
    for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
      m.insert(slot, static_cast<MapSlot>(slot % 2),
               {draw.uniform(-side_m, side_m), draw.uniform(-side_m, side_m)});
    }
    const Found fresh = ask_for_triangles(m, draw);
    for (int i = 0; i < 3'000; ++i) {
      m.change(draw, side_m);
    }
    const Found changed = ask_for_triangles(m, draw);
    ASSERT_GT(fresh.asked, 1'000);
    // A landmark that stands far from all others may not learn of a newer neighbour.
    EXPECT_GE(fresh.found, fresh.asked * 0.99);
    EXPECT_GE(changed.found, changed.asked * 0.97);
  }
}

std::uint64_t entries(const LandmarkIndex& index) {
  return index.visit_triangles({40.0F, 40.0F, 40.0F}, 100.0F, LandmarkIndex::Turn::Either,
                               [](std::uint32_t, std::uint32_t, std::uint32_t) {});
}

TEST(LandmarkIndex, WhatIsErasedLeavesNoTriangleAndItsMemoryIsUsedAgain) {
  Draw draw(8);
  Mirrored m;
  for (int round = 0; round < 60; ++round) {
    for (int i = 0; i < 600; ++i) {
      m.change(draw, round % 2 == 0 ? 30.0 : 90.0);
    }
    for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
      if (m.listed[slot]) {
        m.erase(slot);
      }
    }
    ASSERT_EQ(m.index->size(), 0U);
    ASSERT_EQ(entries(*m.index), 0U) << "round " << round;
  }
  EXPECT_EQ(m.index->triangles_dropped(), 0U);
}

// Landmarks at the end of the range of links that moved a little since they were linked.
TEST(LandmarkIndex, NoLinkOutlivesItsLandmark) {
  Draw draw(9);
  for (int round = 0; round < 400; ++round) {
    Mirrored m;
    const double far_m = LandmarkIndex::kLinkRange_m;
    m.insert(0, 0, {0.0, 0.0});
    m.insert(1, 0, {3.0, 5.0});
    m.insert(2, 0, {far_m - 0.01, 0.0});
    for (const std::uint32_t slot : {0U, 2U, 1U}) {
      const Point2 away{slot == 2 ? draw.uniform(0.0, 0.12) : draw.uniform(-0.12, 0.0), 0.0};
      m.move(slot, m.listed[slot]->second + away);
    }
    for (const std::uint32_t slot : {2U, 0U, 1U}) {
      m.erase(slot);
    }
    ASSERT_EQ(entries(*m.index), 0U);
  }
}

}  // namespace
}  // namespace slamsensor::core
