#include "core/graph/lattice.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace slamsensor::core {
namespace {

constexpr std::int64_t kReach = 65'000 * 1024;

TEST(Lattice, RoundsToTheNearestPlaceAndIsSymmetric) {
  EXPECT_EQ(to_lattice({1.0, -2.5}), (LatticePoint{1024, -2560}));
  EXPECT_EQ(to_lattice({0.4 / 1024, 0.6 / 1024}), (LatticePoint{0, 1}));
  EXPECT_EQ(to_lattice({-0.5 / 1024, 0.5 / 1024}), (LatticePoint{-1, 1}));
  EXPECT_EQ(to_lattice({65'000.0, -65'000.0}), (LatticePoint{kReach, -kReach}));
}

TEST(Lattice, ReachIsInclusive) {
  EXPECT_TRUE(on_lattice({65'000.0, -65'000.0}));
  EXPECT_FALSE(on_lattice({std::nextafter(65'000.0, 1e6), 0.0}));
  EXPECT_FALSE(on_lattice({0.0, std::numeric_limits<double>::quiet_NaN()}));
}

TEST(Lattice, OrientationIsExactAtTheReach) {
  const LatticePoint a{-kReach, -kReach};
  const LatticePoint b{kReach, kReach};
  EXPECT_EQ(orientation(a, b, {0, 0}), 0);
  EXPECT_EQ(orientation(a, b, {0, 1}), 2 * kReach);
  EXPECT_EQ(orientation(a, b, {1, 0}), -2 * kReach);
  EXPECT_EQ(orientation(a, {kReach, -kReach}, {-kReach, kReach}), 4 * kReach * kReach);
}

TEST(Lattice, BetweenExcludesTheEnds) {
  const LatticePoint a{-2, 4};
  const LatticePoint b{4, -8};
  EXPECT_TRUE(strictly_between(a, b, {-1, 2}));
  EXPECT_FALSE(strictly_between(a, b, a));
  EXPECT_FALSE(strictly_between(a, b, b));
  EXPECT_FALSE(strictly_between(a, b, {5, -10}));
  EXPECT_FALSE(strictly_between(a, b, {-3, 6}));
}

// The four corners of the reach lie on one circle; a single step decides.
TEST(Lattice, InCircleIsExactAtTheReach) {
  const LatticePoint a{-kReach, -kReach};
  const LatticePoint b{kReach, -kReach};
  const LatticePoint c{kReach, kReach};
  EXPECT_FALSE(in_circle(a, b, c, {-kReach, kReach}));
  EXPECT_TRUE(in_circle(a, b, c, {-kReach + 1, kReach}));
  EXPECT_TRUE(in_circle(a, b, c, {-kReach, kReach - 1}));
  EXPECT_FALSE(in_circle(a, b, {kReach, kReach - 1}, {-kReach, kReach}));
  EXPECT_FALSE(in_circle(a, b, c, a));
  EXPECT_TRUE(in_circle(a, b, c, {0, 0}));
}

}  // namespace
}  // namespace slamsensor::core
