#include "core/decision/evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace slamsensor::core {
namespace {

/// log10 P(X >= hits), X beta-binomial, summed term by term.
double exact_tail(std::uint32_t trials, std::uint32_t hits, double mean, double weight) {
  const double a = mean * weight;
  const double b = (1.0 - mean) * weight;
  const auto ln_beta = [](double x, double y) {
    return std::lgamma(x) + std::lgamma(y) - std::lgamma(x + y);
  };
  double sum = 0.0;
  for (std::uint32_t k = trials + 1; k-- > hits;) {  // the least first
    const double ln_choose = std::lgamma(trials + 1.0) - std::lgamma(k + 1.0) - std::lgamma(trials - k + 1.0);
    sum += std::exp(ln_choose + ln_beta(k + a, trials - k + b) - ln_beta(a, b));
  }
  return std::log10(sum);
}

TEST(BetaBinomialTail, EqualsTheExactSum) {
  for (const std::uint32_t trials : {1U, 2U, 7U, 30U, 128U}) {
    for (std::uint32_t hits = 1; hits <= trials; hits += 1 + trials / 10) {
      for (const double mean : {0.03, 0.25, 0.5, 0.8}) {
        for (const double weight : {4.0, 25.0, 300.0}) {
          EXPECT_NEAR(log10_beta_binomial_tail(trials, hits, mean, weight),
                      exact_tail(trials, hits, mean, weight), 1e-5)
              << hits << " of " << trials << ", mean " << mean << ", weight " << weight;
        }
      }
    }
  }
}

TEST(BetaBinomialTail, NoHitIsNoSurpriseAndMoreAreMore) {
  EXPECT_EQ(log10_beta_binomial_tail(20, 0, 0.2, 25.0), 0.0);
  EXPECT_EQ(log10_beta_binomial_tail(0, 0, 0.2, 25.0), 0.0);
  double before = 0.0;
  for (std::uint32_t hits = 1; hits <= 20; ++hits) {
    const double tail = log10_beta_binomial_tail(20, hits, 0.2, 25.0);
    EXPECT_LT(tail, before);
    before = tail;
  }
}

}  // namespace
}  // namespace slamsensor::core
