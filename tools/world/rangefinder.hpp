#pragma once

#include "core/reading.hpp"
#include "tools/world/objects.hpp"
#include "tools/world/random.hpp"
#include "tools/world/world_config.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace slamsensor::tools {

inline constexpr std::uint32_t kSubRaysMax = 16;

/// What the rangefinder says of one shot, and, for the tests, what it was that its beam's axis met.
struct Range {
  double range_m = core::Reading::kNoReturn;
  Surface surface = Surface::None;  ///< the truth, also when there is no return
  std::uint32_t index = 0;          ///< of the object, wall or mover

  [[nodiscard]] bool has_return() const noexcept { return range_m >= 0.0; }
};

/// Tangents by which the sub-rays lean away from the beam's axis, to the side and up. The first is the axis;
/// the others fill the cone of `divergence_rad` evenly (a sunflower).
struct BeamPattern {
  explicit BeamPattern(const RangefinderConfig& config) noexcept;

  std::array<std::array<double, 2>, kSubRaysMax> lean{};
  std::uint32_t count = 1;
};

/// One distance out of those that the sub-rays found (m, only the ones that found something; not empty):
/// their mean when they agree within `mixed_gap_m`; else, by chance, the mean of all of them, which may be
/// between two things (a mixed pixel), or the distance of one.
[[nodiscard]] double combine_sub_rays(const RangefinderConfig& config, std::span<const double> distances_m,
                                      Random& rng) noexcept;

/// The reading for a true distance: noise, quantisation, limits. core::Reading::kNoReturn outside the limits.
[[nodiscard]] double disturb(const RangefinderConfig& config, double distance_m, Random& rng) noexcept;

}  // namespace slamsensor::tools
