#include "core/detection/spiderweb.hpp"

#include "tests/unit/core/detection/detection_support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

namespace slamsensor::core {
namespace {

using detection_test::hand_config;
using testing::ElementsAre;
using testing::UnorderedElementsAre;
using tests::InArena;

struct Fixture {
  explicit Fixture(const DetectionConfig& config = hand_config(), std::uint32_t cells_max = 65'536,
                   std::size_t groups_max = 100)
      : web(config, cells_max), groups("groups", groups_max) {}

  void see(std::uint32_t row, std::uint32_t column, int times = 1) {
    for (int i = 0; i < times; ++i) {
      web->add({row, column, 0.0, 0.0});
    }
  }
  const BoundedVector<CellGroup>& take() {
    web->take_heaviest(*groups);
    return *groups;
  }
  std::vector<std::uint32_t> cells(std::size_t group) {
    const auto cells = web->cells((*groups)[group]);
    return {cells.begin(), cells.end()};
  }

  InArena<Spiderweb> web;
  InArena<BoundedVector<CellGroup>> groups;
};

TEST(Spiderweb, WeightIsTheMeanCountOfTheCells) {
  Fixture f;
  f.see(10, 5, 3);
  f.see(11, 6, 4);
  ASSERT_EQ(f.take().size(), 1U);
  EXPECT_EQ((*f.groups)[0].count, 7U);
  EXPECT_EQ((*f.groups)[0].size, 2U);
  EXPECT_EQ((*f.groups)[0].weight(), 3.5);
  EXPECT_THAT(f.cells(0), UnorderedElementsAre(10 * 20 + 5, 11 * 20 + 6));
}

TEST(Spiderweb, CellsThatTouchAtACornerAreOneGroup) {
  Fixture f;
  f.see(10, 5);
  f.see(11, 6);
  f.see(10, 7);
  f.see(12, 5);  // touches (11, 6)
  f.see(10, 9);  // two columns from (10, 7)
  f.see(14, 5);  // two rows from (12, 5)
  ASSERT_EQ(f.take().size(), 3U);
  EXPECT_THAT(f.cells(0), UnorderedElementsAre(205, 226, 207, 245));
}

TEST(Spiderweb, GroupsGoAcrossTheSeam) {
  Fixture f;
  f.see(10, 19);
  f.see(11, 0);
  f.see(10, 1);
  ASSERT_EQ(f.take().size(), 1U);
  EXPECT_THAT(f.cells(0), UnorderedElementsAre(219, 220, 201));
}

TEST(Spiderweb, FirstAndLastRowHaveNoNeighboursBeyond) {
  Fixture f;
  f.see(0, 3);
  f.see(99, 3);
  f.see(0, 13);  // opposite through the origin: not adjacent in the grid
  EXPECT_EQ(f.take().size(), 3U);
}

TEST(Spiderweb, HeaviestFirstThenNearerThenSmallerBearing) {
  Fixture f;
  f.see(50, 2, 2);
  f.see(10, 9);
  f.see(10, 4);
  f.see(70, 12, 5);
  f.see(8, 15);
  std::vector<std::uint32_t> nearest;
  for (const CellGroup& group : f.take()) {
    nearest.push_back(group.nearest_cell);
  }
  EXPECT_THAT(nearest, ElementsAre(70 * 20 + 12, 50 * 20 + 2, 8 * 20 + 15, 10 * 20 + 4, 10 * 20 + 9));
}

TEST(Spiderweb, KeepsTheHeaviestThereIsRoomFor) {
  Fixture f(hand_config(), 65'536, 2);
  for (std::uint32_t i = 0; i < 9; ++i) {
    f.see(10 * i, 5, static_cast<int>((i * 4) % 9) + 1);  // weights 1 5 9 4 8 3 7 2 6
  }
  ASSERT_EQ(f.take().size(), 2U);
  EXPECT_EQ((*f.groups)[0].weight(), 9.0);
  EXPECT_EQ((*f.groups)[1].weight(), 8.0);
}

TEST(Spiderweb, TakingEmptiesTheGrid) {
  Fixture f;
  f.see(10, 5, 3);
  f.see(99, 19);
  EXPECT_EQ(f.web->cells_occupied(), 2U);
  EXPECT_EQ(f.web->count(10, 5), 3U);
  EXPECT_EQ(f.take().size(), 2U);
  EXPECT_EQ(f.web->cells_occupied(), 0U);
  EXPECT_EQ(f.web->count(10, 5), 0U);
  EXPECT_EQ(f.take().size(), 0U);
  f.see(10, 6);
  ASSERT_EQ(f.take().size(), 1U);
  EXPECT_EQ((*f.groups)[0].count, 1U);
}

TEST(Spiderweb, FullListDropsNewCellsAndGoesOnCountingOldOnes) {
  Fixture f(hand_config(), 3);
  f.see(10, 2);
  f.see(20, 4);
  f.see(30, 6);
  EXPECT_EQ(f.web->cells_dropped(), 0U);
  f.see(40, 8, 2);
  f.see(10, 2);
  EXPECT_EQ(f.web->cells_dropped(), 2U);
  EXPECT_EQ(f.web->count(40, 8), 0U);
  ASSERT_EQ(f.take().size(), 3U);
  EXPECT_EQ((*f.groups)[0].weight(), 2.0);
  f.see(40, 8);  // there is room again
  EXPECT_EQ(f.take().size(), 1U);
  EXPECT_EQ(f.web->cells_dropped(), 2U);
}

TEST(Spiderweb, RoomForNoCellsIsDefined) {
  Fixture f(hand_config(), 0);
  f.see(10, 2);
  EXPECT_EQ(f.take().size(), 0U);
  EXPECT_EQ(f.web->cells_dropped(), 1U);
}

TEST(Spiderweb, TakesNoMoreRoomThanThereAreCells) {
  Arena small;
  Arena large;
  const Spiderweb a(small, hand_config(), 2000);
  const Spiderweb b(large, hand_config(), 4'000'000'000U);
  EXPECT_EQ(small.bytes_used(), large.bytes_used());
}

TEST(Spiderweb, FullGridIsOneGroup) {
  Fixture f;
  for (std::uint32_t cell = 0; cell < 2000; ++cell) {
    f.see(cell / 20, cell % 20);
  }
  ASSERT_EQ(f.take().size(), 1U);
  EXPECT_EQ((*f.groups)[0].size, 2000U);
  EXPECT_EQ(f.web->cells_dropped(), 0U);
}

/// Groups by the definition: labels spread to the smallest among all neighbours until nothing changes.
std::set<std::set<std::uint32_t>> groups_of(const std::set<std::uint32_t>& cells, const PolarGrid& grid) {
  std::map<std::uint32_t, std::uint32_t> label;
  for (const std::uint32_t cell : cells) {
    label[cell] = cell;
  }
  const auto touch = [&](std::uint32_t a, std::uint32_t b) {
    const int rows = std::abs(static_cast<int>(a / grid.columns()) - static_cast<int>(b / grid.columns()));
    const int columns = std::abs(static_cast<int>(a % grid.columns()) - static_cast<int>(b % grid.columns()));
    return rows <= 1 && (columns <= 1 || columns == static_cast<int>(grid.columns()) - 1);
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::uint32_t a : cells) {
      for (const std::uint32_t b : cells) {
        if (touch(a, b) && label[b] < label[a]) {
          label[a] = label[b];
          changed = true;
        }
      }
    }
  }
  std::map<std::uint32_t, std::set<std::uint32_t>> by_label;
  for (const auto& [cell, group] : label) {
    by_label[group].insert(cell);
  }
  std::set<std::set<std::uint32_t>> groups;
  for (const auto& [group, members] : by_label) {
    groups.insert(members);
  }
  return groups;
}

TEST(Spiderweb, GroupsAgreeWithTheDefinitionOnRandomGrids) {
  const unsigned seed = 31415;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  DetectionConfig config = hand_config();
  for (const double step_deg : {18.0, 40.0, 120.0, 180.0, 360.0}) {
    config.bearing_step_rad = step_deg * kDegree;
    config.range_max_m = 8.0;
    Fixture f(config);
    for (int round = 0; round < 100; ++round) {
      std::set<std::uint32_t> cells;
      for (auto i = random() % 60; i > 0; --i) {
        cells.insert(static_cast<std::uint32_t>(random() % f.web->grid().cells()));
      }
      std::vector<std::uint32_t> order(cells.begin(), cells.end());
      std::shuffle(order.begin(), order.end(), random);
      for (const std::uint32_t cell : order) {
        f.see(cell / f.web->grid().columns(), cell % f.web->grid().columns());
      }
      std::set<std::set<std::uint32_t>> found;
      f.take();
      for (std::size_t i = 0; i < (*f.groups).size(); ++i) {
        const auto members = f.cells(i);
        found.insert(std::set<std::uint32_t>(members.begin(), members.end()));
      }
      ASSERT_EQ(found, groups_of(cells, f.web->grid())) << "round " << round << " step " << step_deg;
    }
  }
}

TEST(Spiderweb, SumsTheReadingsOfAGroup) {
  DetectionConfig config = hand_config();
  config.point = LandmarkPoint::ReadingMean;
  Fixture f(config);
  for (int scan = 0; scan < 2; ++scan) {  // the second must not find sums of the first
    f.web->add({10, 4, 10.0, 90.0 * kDegree});
    f.web->add({10, 4, 10.5, 90.0 * kDegree});
    f.web->add({10, 5, 10.0, 180.0 * kDegree});
    ASSERT_EQ(f.take().size(), 1U);
    EXPECT_NEAR((*f.groups)[0].sum_x_m, -10.0, 1e-12);
    EXPECT_NEAR((*f.groups)[0].sum_y_m, 20.5, 1e-12);
  }
}

}  // namespace
}  // namespace slamsensor::core
