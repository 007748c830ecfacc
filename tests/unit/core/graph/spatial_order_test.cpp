#include "core/graph/spatial_order.hpp"

#include "core/graph/radix_sort.hpp"
#include "tests/support/graph_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace slamsensor::tests {
namespace {

std::vector<std::uint32_t> indices_of(const std::vector<std::uint64_t>& keys) {
  std::vector<std::uint32_t> indices;
  for (const std::uint64_t key : keys) {
    indices.push_back(static_cast<std::uint32_t>(key));
  }
  return indices;
}

std::vector<core::LatticePoint> places_of(const Points& points) {
  std::vector<core::LatticePoint> places;
  for (const core::Point2& p : points) {
    places.push_back(core::to_lattice(p));
  }
  return places;
}

TEST(RadixSort, SortsByTheGivenBitsAndKeepsTheOrderOfTheRest) {
  std::mt19937_64 random(11);
  for (const std::uint32_t last : {21U, 33U, 64U}) {
    for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
      std::vector<std::uint64_t> keys(count);
      std::generate(keys.begin(), keys.end(), [&] { return random() & random(); });
      std::vector<std::uint64_t> expected = keys;
      const auto part = [last](std::uint64_t key) { return (key << (64 - last)) >> (64 - last + 10); };
      std::ranges::stable_sort(expected, {}, part);
      std::vector<std::uint64_t> scratch(count + 3);
      core::radix_sort(keys, scratch, 10, last);
      EXPECT_EQ(keys, expected) << last << " bits, " << count << " keys";
    }
  }
}

TEST(SpatialOrder, HoldsEveryPointOnce) {
  for (const double side_m : {0.0, 0.5, 130'000.0}) {
    const auto places = places_of(uniform_points(1000, side_m, 2));
    std::vector<std::uint64_t> keys(1000);
    std::vector<std::uint64_t> scratch(1000);
    core::spatial_order(places, keys, scratch);
    std::vector<std::uint32_t> indices = indices_of(keys);
    std::ranges::sort(indices);
    std::vector<std::uint32_t> all(1000);
    std::iota(all.begin(), all.end(), 0U);
    EXPECT_EQ(indices, all) << side_m;
  }
}

// 10,000 points in a square of 100 m: at random the next would be 52 m away, at best about 1 m.
TEST(SpatialOrder, NeighboursInTheOrderAreNearInThePlane) {
  const Points points = uniform_points(10'000, 100.0, 3);
  std::vector<std::uint64_t> keys(points.size());
  std::vector<std::uint64_t> scratch(points.size());
  core::spatial_order(places_of(points), keys, scratch);
  const std::vector<std::uint32_t> order = indices_of(keys);
  double way_m = 0.0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    way_m += (points[order[i]] - points[order[i - 1]]).norm();
  }
  EXPECT_LT(way_m / 10'000, 2.5);
}

TEST(SpatialOrder, LineOrderFollowsTheLineAndThenTheIndex) {
  const std::vector<core::LatticePoint> upright{{5, 9}, {5, -9}, {5, 0}, {5, -9}};
  const std::vector<core::LatticePoint> falling{{2, -2}, {-1, 1}, {2, -2}, {0, 0}};
  std::vector<std::uint64_t> keys(4);
  std::vector<std::uint64_t> scratch(4);
  core::line_order(upright, keys, scratch);
  EXPECT_EQ(indices_of(keys), (std::vector<std::uint32_t>{1, 3, 2, 0}));
  core::line_order(falling, keys, scratch);
  EXPECT_EQ(indices_of(keys), (std::vector<std::uint32_t>{1, 3, 0, 2}));
}

}  // namespace
}  // namespace slamsensor::tests
