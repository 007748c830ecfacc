#pragma once

#include "core/geometry/pose2.hpp"
#include "core/memory/fixed_vector.hpp"

#include <array>

namespace slamsensor::core {

/// Up to two poses T_W_L (the second is the mirror image of the first in the line of collinear landmarks).
using PoseCandidates = FixedVector<Pose2, 2>;

/// The poses from which three landmarks at `map_W` (m, W) are seen at `scan_L` (m, L): the sensor stands
/// where the circles about the two landmarks with the best-conditioned crossing meet, if the third circle
/// passes within `tolerance_m`; its heading is the circular mean of the three differences of bearing.
/// Collinear landmarks yield both conjugates. Empty when the circles miss each other by more than the
/// tolerance, or when all three landmarks are in line with the sensor, so that their circles touch and give
/// no place (the paper's section II-B).
[[nodiscard]] PoseCandidates triangulate(const std::array<Point2, 3>& scan_L,
                                         const std::array<Point2, 3>& map_W, double tolerance_m) noexcept;

}  // namespace slamsensor::core
