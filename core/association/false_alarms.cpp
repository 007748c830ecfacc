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
  double choices_log =
      0.0;  // of trials over hits; the product stays in range for a hundred factors at a time
  double choices = 1.0;
  for (std::uint32_t i = 1; i <= hits; ++i) {
    choices *= static_cast<double>(trials - hits + i) / i;
    if (choices > 1e200) {
      choices_log += std::log(choices);
      choices = 1.0;
    }
  }
  const double log_first = choices_log + std::log(choices) + static_cast<double>(hits) * std::log(p) +
                           static_cast<double>(trials - hits) * std::log1p(-p);
  const double odds = p / (1.0 - p);
  double term = 1.0;
  double sum = 1.0;
  for (std::uint32_t h = hits; h < trials; ++h) {
    term *= static_cast<double>(trials - h) / (h + 1) * odds;
    sum += term;
  }
  return std::min(0.0, (log_first + std::log(sum)) / std::log(10.0));
}

double log10_chance_of_matches(std::uint32_t landmarks, std::span<const double> shares, double p) noexcept {
  // Nearer than this nothing is measured: a match at a distance of nought is not infinitely convincing.
  constexpr double kShareMin = 0.01;
  double best = 0.0;
  for (std::size_t matches = 4; matches <= shares.size(); ++matches) {
    // The pose was fitted to the matches, which took 3 of their 2 * matches degrees of freedom.
    const double unfitted = 2.0 * static_cast<double>(matches) / (2.0 * static_cast<double>(matches) - 3.0);
    const double chance = p * std::clamp(shares[matches - 1] * unfitted, kShareMin, 1.0);
    best =
        std::min(best, log10_binomial_tail(landmarks - 3, static_cast<std::uint32_t>(matches - 3), chance));
  }
  return shares.size() <= 3 ? 0.0 : std::min(0.0, best + std::log10(static_cast<double>(shares.size() - 3)));
}

double log10_rival_chance(std::uint32_t best, std::uint32_t rival) noexcept {
  return log10_binomial_tail(best + rival, best, 0.5);
}

}  // namespace slamsensor::core
