#include "tools/world/rangefinder.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slamsensor::tools {

BeamPattern::BeamPattern(const RangefinderConfig& config) noexcept
    : count(std::clamp(config.sub_rays, 1U, kSubRaysMax)) {
  constexpr double kGoldenAngle_rad = 2.399963229728653;
  const double half_width = std::tan(0.5 * config.divergence_rad);
  for (std::uint32_t i = 1; i < count; ++i) {
    const double radius = half_width * std::sqrt(static_cast<double>(i) / (count - 1));
    lean[i] = {radius * std::cos(i * kGoldenAngle_rad), radius * std::sin(i * kGoldenAngle_rad)};
  }
}

double combine_sub_rays(const RangefinderConfig& config, std::span<const double> distances_m,
                        Random& rng) noexcept {
  const double mean_m =
      std::accumulate(distances_m.begin(), distances_m.end(), 0.0) / static_cast<double>(distances_m.size());
  const auto [near, far] = std::minmax_element(distances_m.begin(), distances_m.end());
  if (*far - *near <= config.mixed_gap_m || draw_unit(rng) < config.mixed_share) {
    return mean_m;
  }
  return distances_m[static_cast<std::size_t>(draw_unit(rng) * static_cast<double>(distances_m.size()))];
}

double disturb(const RangefinderConfig& config, double distance_m, Random& rng) noexcept {
  double range_m = distance_m;
  if (config.noise_sigma_m > 0.0) {
    range_m += config.noise_sigma_m * draw_normal(rng);
  }
  if (config.resolution_m > 0.0) {
    range_m = config.resolution_m * std::floor(range_m / config.resolution_m + 0.5);
  }
  const bool measurable =
      distance_m >= config.range_min_m && distance_m <= config.range_max_m && range_m >= 0.0;
  return measurable && range_m <= config.range_max_m ? range_m : core::Reading::kNoReturn;
}

}  // namespace slamsensor::tools
