#include "core/association/false_alarms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamsensor::core {

double log10_binomial_tail(std::uint32_t trials, std::uint32_t hits, double p) noexcept {
  if (hits == 0 || p >= 1.0) {
    return hits > trials ? -std::numeric_limits<double>::infinity() : 0.0;
  }
  if (hits > trials || p <= 0.0) {
    return -std::numeric_limits<double>::infinity();
  }
  // The first term, then each next one from the one before: t(h+1) = t(h) (n-h)/(h+1) p/(1-p).
  double log_first = static_cast<double>(hits) * std::log(p) + static_cast<double>(trials - hits) * std::log1p(-p);
  for (std::uint32_t i = 1; i <= hits; ++i) {
    log_first += std::log(static_cast<double>(trials - hits + i) / i);
  }
  const double odds = p / (1.0 - p);
  double term = 1.0;
  double sum = 1.0;
  for (std::uint32_t h = hits; h < trials; ++h) {
    term *= static_cast<double>(trials - h) / (h + 1) * odds;
    sum += term;
  }
  return std::min(0.0, (log_first + std::log(sum)) / std::log(10.0));
}

double log10_expected_false_alarms(std::uint64_t poses_tried, std::uint32_t landmarks, std::uint32_t matches,
                                   double p) noexcept {
  const double tests = std::log10(static_cast<double>(std::max<std::uint64_t>(poses_tried, 1)));
  if (matches <= 3 || landmarks <= 3) {
    return tests;
  }
  return tests + log10_binomial_tail(landmarks - 3, matches - 3, p);
}

double log10_rival_chance(std::uint32_t only_best, std::uint32_t only_rival) noexcept {
  return log10_binomial_tail(only_best + only_rival, only_best, 0.5);
}

}  // namespace slamsensor::core
