#include "core/detection/scanline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace slamsensor::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int32_t kInf = kInfiniteColumn;
constexpr std::int32_t kEmpty = kEmptyColumn;

std::vector<std::uint32_t> unobstructed(const std::vector<std::int32_t>& row) {
  std::vector<std::uint32_t> columns(row.size());
  columns.resize(find_unobstructed(row, columns));
  std::sort(columns.begin(), columns.end());
  return columns;
}

// In the manner of the paper's Fig. 4: every way a cluster can end, and one that lies across the seam.
TEST(Clusters, HandWorkedScanline) {
  const std::vector<std::int32_t> row{
      10,  //  0  } third and fourth column of the cluster 18, 19, 0, 1: 12 below infinite at 17, 11 below 30
           //  at 2,
      11,  //  1  } so it is kept, across the seam
      30,  //  2  } obstructed on the left: 30 is not below 11
      31,  //  3  }
      kInf,    //  4
      20,      //  5  } kept: no return on either side
      21,      //  6  }
      20,      //  7  }
      kInf,    //  8
      40,      //  9  obstructed on the right: 40 is not below 15
      15,      // 10  kept: in front of 40 and of 25
      25,      // 11  obstructed on both sides: 15 and 18
      18,      // 12  obstructed on the right: an empty column counts as zero
      kEmpty,  // 13
      5,       // 14  obstructed on the left: empty again, although nothing is nearer
      50,      // 15  obstructed on both sides: 5 and 22
      22,      // 16  kept: in front of 50, no return on the right
      kInf,    // 17
      12,      // 18  } first and second column of the cluster across the seam
      11,      // 19  }
  };
  EXPECT_THAT(unobstructed(row), ElementsAre(0, 1, 5, 6, 7, 10, 16, 18, 19));
}

TEST(Clusters, StepOfTwoParts) {
  // 10 | 12: two clusters; the left one is in front on its right side, the right one is behind on its left.
  EXPECT_THAT(unobstructed({kInf, 10, 10, 12, 12, kInf}), ElementsAre(1, 2));
  EXPECT_THAT(unobstructed({kInf, 10, 11, 12, 13, kInf}), ElementsAre(1, 2, 3, 4));  // a slope is one cluster
}

TEST(Clusters, OnlyTheEndsDecide) {
  // The middle of the cluster is farther than what stands beside it; its ends are not.
  EXPECT_THAT(unobstructed({10, 11, 12, 11, 10, 12}), ElementsAre(0, 1, 2, 3, 4));
}

TEST(Clusters, DistanceZeroIsStillADistance) {
  EXPECT_THAT(unobstructed({kInf, 0, 1, kInf}), ElementsAre(1, 2));
  EXPECT_THAT(unobstructed({kInf, 0, kEmpty, kInf}),
              IsEmpty());  // empty and zero do not cluster, nor is 0 below it
}

TEST(Clusters, AllTheWayRoundIsNoLandmark) {
  EXPECT_THAT(unobstructed(std::vector<std::int32_t>(20, 7)), IsEmpty());
  EXPECT_THAT(unobstructed({1, 2, 3, 4, 3, 2}), IsEmpty());
}

TEST(Clusters, SpiralEndsAtItsOwnStart) {
  // Every neighbour differs by one but across the seam: one cluster with two ends, of which the far one
  // adjoins the near one.
  EXPECT_THAT(unobstructed({10, 11, 12, 13, 14, 15}), IsEmpty());
}

TEST(Clusters, NothingSeen) {
  EXPECT_THAT(unobstructed(std::vector<std::int32_t>(20, kInf)), IsEmpty());
  EXPECT_THAT(unobstructed(std::vector<std::int32_t>(20, kEmpty)), IsEmpty());
  EXPECT_THAT(unobstructed({kInf, kEmpty, kInf, kEmpty}), IsEmpty());
}

TEST(Clusters, FewestColumns) {
  EXPECT_THAT(unobstructed({}), IsEmpty());
  EXPECT_THAT(unobstructed({3}), IsEmpty());  // its own neighbour: all the way round
  EXPECT_THAT(unobstructed({kInf}), IsEmpty());
  EXPECT_THAT(unobstructed({3, kInf}), ElementsAre(0));
  EXPECT_THAT(unobstructed({3, 4}), IsEmpty());
  EXPECT_THAT(unobstructed({9, 3}), ElementsAre(1));
}

/// The definition, column by column: walk to both ends of the column's cluster and look at what adjoins them.
bool is_kept(const std::vector<std::int32_t>& row, std::size_t column) {
  const std::size_t n = row.size();
  const auto is_distance = [](std::int32_t d) { return d != kInf && d != kEmpty; };
  const auto joined = [&](std::size_t a, std::size_t b) {
    return is_distance(row[a]) && is_distance(row[b]) && std::abs(row[a] - row[b]) <= 1;
  };
  if (!is_distance(row[column])) {
    return false;
  }
  std::size_t left = column;
  std::size_t right = column;
  for (std::size_t i = 0; i < n && joined(left, (left + n - 1) % n); ++i) {
    left = (left + n - 1) % n;
  }
  std::size_t steps = 0;
  for (; steps < n && joined(right, (right + 1) % n); ++steps) {
    right = (right + 1) % n;
  }
  return steps < n && row[left] < row[(left + n - 1) % n] && row[right] < row[(right + 1) % n];
}

TEST(Clusters, AgreesWithTheDefinitionOnRandomRows) {
  const unsigned seed = 4711;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::int32_t> row(1 + random() % 12);
    for (std::int32_t& d_cell : row) {
      const auto draw = static_cast<std::int32_t>(random() % 8);
      d_cell = draw == 0 ? kEmpty : draw == 1 ? kInf : draw - 2;
    }
    std::vector<std::uint32_t> expected;
    for (std::uint32_t column = 0; column < row.size(); ++column) {
      if (is_kept(row, column)) {
        expected.push_back(column);
      }
    }
    ASSERT_EQ(unobstructed(row), expected) << "round " << round << ": " << testing::PrintToString(row);
  }
}

}  // namespace
}  // namespace slamsensor::core
