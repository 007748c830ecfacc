#include "core/geometry/convex_hull.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

// An area below this share of the square of the extent is rounding; the thinnest cell of 10^6 columns has far
// more.
constexpr double kNoArea = 1e-12;

double cross(const Point2& a, const Point2& b) noexcept {
  return a.x() * b.y() - a.y() * b.x();
}

/// Appends `point` to the chain hull[0, size), after dropping the vertices that it makes concave or
/// superfluous down to `size_min`; returns the new size.
std::size_t extend(std::span<Point2> hull, std::size_t size, std::size_t size_min,
                   const Point2& point) noexcept {
  while (size > size_min && cross(hull[size - 1] - hull[size - 2], point - hull[size - 2]) <= 0.0) {
    --size;
  }
  hull[size] = point;
  return size + 1;
}

Point2 mean_of(std::span<const Point2> points) noexcept {
  Point2 sum = Point2::Zero();
  for (const Point2& point : points) {
    sum += point;
  }
  return points.empty() ? sum : Point2(sum / static_cast<double>(points.size()));
}

}  // namespace

std::size_t convex_hull(std::span<Point2> points, std::span<Point2> hull) noexcept {
  SLAMSENSOR_ASSERT(hull.size() >= 2 * points.size());
  if (points.size() < 2) {
    std::copy(points.begin(), points.end(), hull.begin());
    return points.size();
  }
  std::sort(points.begin(), points.end(),
            [](const Point2& a, const Point2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::size_t size = 0;
  for (const Point2& point : points) {  // below, left to right
    size = extend(hull, size, 1, point);
  }
  const std::size_t below = size;
  for (std::size_t i = points.size() - 1; i-- > 0;) {  // above, right to left
    size = extend(hull, size, below, points[i]);
  }
  return size - 1;  // the leftmost point has come again
}

Point2 area_centroid(std::span<const Point2> polygon) noexcept {
  if (polygon.empty()) {
    return Point2::Zero();
  }
  // A fan of triangles from the first vertex: coordinates relative to it keep the digits of a small far
  // polygon.
  const Point2& origin = polygon.front();
  double twice_area = 0.0;
  double extent_squared = 0.0;
  Point2 moment = Point2::Zero();
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    const Point2 a = polygon[i - 1] - origin;
    const Point2 b = polygon[i] - origin;
    const double twice_triangle = cross(a, b);
    twice_area += twice_triangle;
    moment += twice_triangle * (a + b);
    extent_squared = std::max(extent_squared, b.squaredNorm());
  }
  if (std::abs(twice_area) <= kNoArea * extent_squared) {
    return mean_of(polygon);
  }
  return origin + moment / (3.0 * twice_area);
}

}  // namespace slamsensor::core
