#include "core/association/false_alarms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slamsensor::core {
namespace {

double direct_tail(std::uint32_t n, std::uint32_t k, double p) {
  double sum = 0.0;
  for (std::uint32_t h = k; h <= n; ++h) {
    sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(h + 1.0) - std::lgamma(n - h + 1.0) + h * std::log(p) +
                    (n - h) * std::log1p(-p));
  }
  return sum;
}

TEST(FalseAlarms, TailEqualsTheDirectSum) {
  for (const std::uint32_t n : {1U, 2U, 7U, 27U, 92U}) {
    for (const double p : {0.001, 0.02, 0.3, 0.9}) {
      for (std::uint32_t k = 1; k <= n; k += 1 + n / 7) {
        EXPECT_NEAR(log10_binomial_tail(n, k, p), std::log10(direct_tail(n, k, p)), 1e-6)
            << n << ' ' << k << ' ' << p;
      }
    }
  }
}

TEST(FalseAlarms, TailAtItsEnds) {
  EXPECT_EQ(log10_binomial_tail(10, 0, 0.5), 0.0);
  EXPECT_EQ(log10_binomial_tail(10, 3, 1.0), 0.0);
  EXPECT_TRUE(std::isinf(log10_binomial_tail(10, 11, 0.5)));
  EXPECT_TRUE(std::isinf(log10_binomial_tail(10, 11, 1.0)));
  EXPECT_TRUE(std::isinf(log10_binomial_tail(10, 1, 0.0)));
  EXPECT_NEAR(log10_binomial_tail(100, 100, 1e-9), -900.0, 1e-6);  // no underflow
}

// By hand: 20 landmarks, 8 matched at the very tolerance, chance 0.01 each. 17 trials, 5 hits: C(17,5) 1e-10
// 0.99^12 = 5.5e-7 is the smallest tail, and 5 were looked at.
TEST(FalseAlarms, MatchesAHandWorkedCase) {
  const std::vector<double> shares(8, 1.0);
  EXPECT_NEAR(log10_chance_of_matches(20, shares, 0.01), std::log10(5.0 * 5.5e-7), 0.02);
}

TEST(FalseAlarms, ThreeMatchesSayNothing) {
  EXPECT_EQ(log10_chance_of_matches(20, std::vector<double>(3, 0.1), 0.01), 0.0);
  EXPECT_EQ(log10_chance_of_matches(2, {}, 0.01), 0.0);
}

TEST(FalseAlarms, MoreMatchesNearerMatchesAndThinnerMapsAreMoreConvincing) {
  const std::vector<double> eight(8, 0.5);
  EXPECT_LT(log10_chance_of_matches(20, std::vector<double>(9, 0.5), 0.01),
            log10_chance_of_matches(20, eight, 0.01));
  EXPECT_LT(log10_chance_of_matches(20, std::vector<double>(8, 0.1), 0.01),
            log10_chance_of_matches(20, eight, 0.01));
  EXPECT_LT(log10_chance_of_matches(20, eight, 0.005), log10_chance_of_matches(20, eight, 0.01));
}

TEST(FalseAlarms, AStrayMatchDoesNotSpoilNearOnes) {
  std::vector<double> shares(9, 0.02);
  const double without = log10_chance_of_matches(20, shares, 0.02);
  shares.push_back(1.0);
  EXPECT_LE(log10_chance_of_matches(20, shares, 0.02), without + 0.1);
}

TEST(FalseAlarms, RivalChanceIsTheSignTest) {
  EXPECT_EQ(log10_rival_chance(0, 0), 0.0);
  EXPECT_NEAR(log10_rival_chance(10, 0), -10.0 * std::log10(2.0), 1e-9);
  EXPECT_NEAR(std::pow(10.0, log10_rival_chance(3, 1)), 5.0 / 16.0, 1e-9);  // (4 + 1) / 2^4
}

}  // namespace
}  // namespace slamsensor::core
