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

// The ground may say that there is something near where there is nothing, never the reverse: also after
// landmarks crept away from where they were linked, and in a row and a column, which share words unlike a
// square does.
TEST(LandmarkIndex, TheGroundNeverHidesALandmark) {
  for (const Point2& extent : {Point2(60.0, 60.0), Point2(900.0, 3.0), Point2(3.0, 900.0)}) {
    Draw draw(23);
    Mirrored m;
    std::size_t refused = 0;
    const auto somewhere = [&] {
      return Point2{draw.uniform(-1.0, 1.0) * extent.x(), draw.uniform(-1.0, 1.0) * extent.y()};
    };
    for (int i = 0; i < 8'000; ++i) {
      const std::uint32_t slot = draw.below(kSlots);
      if (!m.listed[slot]) {
        m.insert(slot, static_cast<MapSlot>(draw.below(3)), somewhere());
      } else if (draw.below(8) == 0) {
        m.erase(slot);
      } else {
        m.move(slot, m.listed[slot]->second + Point2(draw.normal(0.04), draw.normal(0.04)));
      }
      const std::uint32_t other = draw.below(kSlots);
      if (m.listed[other]) {
        const auto& [map, p] = *m.listed[other];
        const double turn_rad = draw.uniform(0.0, 6.3);
        const double away_m = 0.99 * m.index->ground_reach_m();
        EXPECT_TRUE(m.index->may_be_near(map, p + away_m * Point2(std::cos(turn_rad), std::sin(turn_rad))));
        refused += m.index->may_be_near(map, somewhere()) ? 0 : 1;
      }
    }
    EXPECT_GT(refused, 1'000U);
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

/// The landmark that a ray of the star of `apex` leads to.
std::uint32_t corner(Mirrored& m, std::uint32_t apex, std::uint32_t ray) {
  const LandmarkIndex::Offset offset = m.index->star(apex)[ray];
  const Point2 there =
      m.listed[apex]->second + Point2(static_cast<double>(offset.x_m()), static_cast<double>(offset.y_m()));
  std::uint32_t nearest = kSlots;
  double nearest_m = 4.0 * m.config.tolerance_m;
  for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
    const bool is_there = m.listed[slot] && m.listed[slot]->first == m.listed[apex]->first;
    if (is_there && (m.listed[slot]->second - there).norm() < nearest_m) {
      nearest_m = (m.listed[slot]->second - there).norm();
      nearest = slot;
    }
  }
  return nearest;
}

/// Whether the index shows the triangle of three landmarks that turns so.
bool shows(Mirrored& m, const LandmarkIndex::Sides& sides, LandmarkIndex::Turn turn,
           const std::array<std::uint32_t, 3>& triangle) {
  bool is_found = false;
  m.index->visit_triangles(
      sides, 0.55F, turn,
      [&](std::uint32_t apex, LandmarkIndex::Pair pair) {
        if (apex == triangle[0]) {
          const std::uint32_t a = corner(m, apex, pair.first);
          const std::uint32_t b = corner(m, apex, pair.second);
          is_found =
              is_found || (a == triangle[1] && b == triangle[2]) || (a == triangle[2] && b == triangle[1]);
        }
      },
      [](std::uint32_t) { return true; });
  return is_found;
}

struct Found {
  int asked = 0;
  int found = 0;
  int turned_over = 0;
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
        const bool is_left = turn > 0.0;
        using Turn = LandmarkIndex::Turn;
        const std::array<std::uint32_t, 3> triangle{slot, near[j], near[i]};
        const bool is_found = shows(m, sides, is_left ? Turn::CounterClockwise : Turn::Clockwise, triangle);
        const bool is_turned = shows(m, sides, is_left ? Turn::Clockwise : Turn::CounterClockwise, triangle);
        result.turned_over += is_turned && std::abs(turn) >= 0.5 * (b - c).norm() ? 1 : 0;
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
    // Of two triangles that share a bucket and a tag each is shown for the other: the caller checks.
    EXPECT_LE(fresh.turned_over, fresh.asked / 200);
    EXPECT_LE(changed.turned_over, changed.asked / 200);
  }
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
    ASSERT_EQ(m.index->triangles(), 0U) << "round " << round;
  }
  EXPECT_EQ(m.index->triangles_dropped(), 0U);
}

// Whatever was changed before, the stars are those of an index that was filled at once, but for what moves
// below the threshold leave behind.
TEST(LandmarkIndex, StarsFollowTheChanges) {
  for (std::uint64_t seed = 11; seed < 14; ++seed) {
    Draw draw(seed);
    Mirrored m;
    for (int i = 0; i < 5'000; ++i) {
      m.change(draw, 60.0);
    }
    int linked = 0;
    int expected = 0;
    for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
      if (!m.listed[slot]) {
        continue;
      }
      const auto near = neighbours(m, slot);
      for (const std::uint32_t other : near) {
        bool is_linked = false;
        for (std::uint32_t ray = 0; ray < m.config.index_neighbours; ++ray) {
          is_linked = is_linked || (m.index->star(slot)[ray].is_some() && corner(m, slot, ray) == other);
        }
        linked += is_linked ? 1 : 0;
        ++expected;
      }
    }
    ASSERT_GT(expected, 500);
    EXPECT_GE(linked, 0.97 * expected);
  }
}

std::size_t bytes_per_landmark(std::uint32_t landmarks, std::uint32_t neighbours) {
  AssociationConfig config;
  config.index_neighbours = neighbours;
  Capacities capacities;
  capacities.map_landmarks = landmarks;
  Arena measuring;
  const LandmarkIndex index(measuring, config, capacities);
  return (measuring.bytes_used() + landmarks - 1) / landmarks;
}

TEST(LandmarkIndex, ALandmarkTakesAtMost128BytesAnd64WithThreeNeighbours) {
  for (const std::uint32_t landmarks :
       {1'000U, 1'025U, 5'000U, 10'000U, 33'000U, 66'000U, 100'000U, 140'000U, 600'000U, 1'000'000U}) {
    EXPECT_LE(bytes_per_landmark(landmarks, AssociationConfig{}.index_neighbours), 128U) << landmarks;
    EXPECT_LE(bytes_per_landmark(landmarks, LandmarkIndex::kNeighboursMin), 64U) << landmarks;
  }
}

// Room is planned from the mean: rows and crowds, whose triangles fall into few buckets, have to fit as well.
TEST(LandmarkIndex, AFullMapOfRowsOrCrowdsFindsRoomForItsTriangles) {
  for (const double jitter_m : {0.0, 0.3}) {
    for (const bool is_crowd : {false, true}) {
      Draw draw(17);
      Mirrored m;
      for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
        const Point2 row{3.0 * (slot % 15), 5.0 * (slot / 15)};
        const Point2 crowd{40.0 * (slot / 12) + draw.normal(4.0), draw.normal(4.0)};
        m.insert(slot, 0, (is_crowd ? crowd : row) + Point2(draw.normal(jitter_m), draw.normal(jitter_m)));
      }
      EXPECT_EQ(m.index->triangles_dropped(), 0U) << jitter_m << is_crowd;
      EXPECT_GT(m.index->triangles(), 4U * kSlots);
    }
  }
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
    ASSERT_EQ(m.index->triangles(), 0U);
  }
}

}  // namespace
}  // namespace slamsensor::core
