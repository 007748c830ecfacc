#pragma once

#include "core/association/candidate.hpp"
#include "core/association/map_view.hpp"
#include "core/geometry/pose2.hpp"

#include <span>

namespace slamsensor::core {

/// Mean chance that a landmark of the scan falls within `tolerance_m` of some landmark of the map by
/// accident, from the map's density in the neighbourhood of where `pose_W` puts each of them. In [0, 1].
[[nodiscard]] double chance_match(const Pose2& pose_W, std::span<const Point2> scan_L, const MapView& map,
                                  double tolerance_m) noexcept;

/// log10 of a bound on the chance that one wrong pose matches the map as well as `candidate` does
/// (log10_chance_of_matches with the density of the map about the candidate's pose).
[[nodiscard]] double log10_chance(const Candidate& candidate, std::span<const Point2> scan_L,
                                  const MapView& map, double tolerance_m) noexcept;

}  // namespace slamsensor::core
