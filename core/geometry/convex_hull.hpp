#pragma once

#include "core/geometry/pose2.hpp"

#include <cstddef>
#include <span>

namespace slamsensor::core {

/// Writes the vertices of the convex hull of `points` (m, sorted in place) to `hull`, counter-clockwise,
/// without points inside an edge, and returns how many. `hull` has room for twice as many as there are
/// points. Points on one line give its two ends (the same one twice if all coincide), one point gives itself,
/// none nothing. Andrew's monotone chain (Information Processing Letters 9, 1979).
[[nodiscard]] std::size_t convex_hull(std::span<Point2> points, std::span<Point2> hull) noexcept;

/// The centroid of the area of a simple polygon (m); of one without area, the mean of its vertices; the
/// origin if there are none.
[[nodiscard]] Point2 area_centroid(std::span<const Point2> polygon) noexcept;

}  // namespace slamsensor::core
