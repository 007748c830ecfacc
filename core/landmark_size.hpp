#pragma once

#include <algorithm>
#include <cmath>

namespace slamsensor::core {

/// How thick a landmark is, by what its sightings measured. Means are of logarithms: the error of a diameter
/// is a share of it. Plain values.
struct LandmarkSize {
  float ln_diameter = 0.0F;  ///< mean of ln (diameter / m)
  float sightings = 0.0F;    ///< that measured it; 0: none did

  /// What one sighting measured; a diameter outside [1 mm, 1 km] is none.
  [[nodiscard]] static LandmarkSize seen(double diameter_m) noexcept {
    const bool is_size = diameter_m >= 1e-3 && diameter_m <= 1e3;
    return is_size ? LandmarkSize{static_cast<float>(std::log(diameter_m)), 1.0F} : LandmarkSize{};
  }
  [[nodiscard]] bool is_known() const noexcept { return sightings > 0.0F; }
  /// m; 0 while it is not known.
  [[nodiscard]] double diameter_m() const noexcept {
    return is_known() ? std::exp(static_cast<double>(ln_diameter)) : 0.0;
  }
  /// The variance of the mean, in those of one sighting. What sightings have in common, as the side from
  /// which they looked, does not average out.
  [[nodiscard]] double variance_share() const noexcept {
    constexpr double kCommon = 0.3;
    return kCommon + (1.0 - kCommon) / static_cast<double>(sightings);
  }
  /// Takes in what other sightings measured. Trees grow: of the old ones no more than kMemory count.
  void add(const LandmarkSize& other) noexcept {
    constexpr float kMemory = 100.0F;
    if (other.is_known()) {
      const float sum = sightings + other.sightings;
      ln_diameter += (other.ln_diameter - ln_diameter) * other.sightings / sum;
      sightings = std::min(sum, kMemory);
    }
  }
  /// Whether sightings can have given it.
  [[nodiscard]] bool is_possible() const noexcept {
    return sightings >= 0.0F && sightings <= 1e6F && std::abs(ln_diameter) <= 7.0F;
  }
};

}  // namespace slamsensor::core
