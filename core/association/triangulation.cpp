#include "core/association/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace slamsensor::core {
namespace {

// Two circles that cross at less than this angle fix the place too badly across the line of their centres.
constexpr double kCrossingSineMin = 0.1;

double cross(const Point2& a, const Point2& b) noexcept {
  return a.x() * b.y() - a.y() * b.x();
}

/// Sine of the angle at which the circles about a and b cross at the sensor (origin of L).
double crossing_sine(const Point2& a, const Point2& b) noexcept {
  const double radii = a.norm() * b.norm();
  return radii > 0.0 ? std::abs(cross(a, b)) / radii : 0.0;
}

/// Index of the landmark to leave out, so that the circles about the other two cross best; 3 when none cross
/// well.
std::size_t worst_partner(const std::array<Point2, 3>& scan_L) noexcept {
  std::size_t left_out = 3;
  double best = kCrossingSineMin;
  for (std::size_t i = 0; i < 3; ++i) {
    const double sine = crossing_sine(scan_L[(i + 1) % 3], scan_L[(i + 2) % 3]);
    if (sine > best) {
      best = sine;
      left_out = i;
    }
  }
  return left_out;
}

double circular_mean_heading(const std::array<Point2, 3>& scan_L, const std::array<Point2, 3>& map_W,
                             const Point2& sensor_W) noexcept {
  Point2 sum = Point2::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    // The direction seen in W times the conjugate of the one seen in L: their angle is the heading.
    const Point2 w = map_W[i] - sensor_W;
    const Point2& l = scan_L[i];
    sum += Point2(w.dot(l), cross(l, w));
  }
  return std::atan2(sum.y(), sum.x());
}

}  // namespace

PoseCandidates triangulate(const std::array<Point2, 3>& scan_L, const std::array<Point2, 3>& map_W,
                           double tolerance_m) noexcept {
  PoseCandidates poses;
  const std::size_t third = worst_partner(scan_L);
  if (third == 3) {
    return poses;
  }
  const std::size_t a = (third + 1) % 3;
  const std::size_t b = (third + 2) % 3;
  const Point2 baseline = map_W[b] - map_W[a];
  const double length_m = baseline.norm();
  if (length_m <= 0.0) {
    return poses;
  }
  const Point2 along = baseline / length_m;
  const Point2 across(-along.y(), along.x());
  const double radius_a2 = scan_L[a].squaredNorm();
  const double radius_b2 = scan_L[b].squaredNorm();
  const double foot_m = (radius_a2 - radius_b2 + length_m * length_m) / (2.0 * length_m);
  const double height2 = radius_a2 - foot_m * foot_m;
  if (height2 < -tolerance_m * (std::sqrt(radius_a2) + std::abs(foot_m))) {
    return poses;  // the circles miss each other by more than the tolerance
  }
  const double height_m = std::sqrt(std::max(height2, 0.0));
  for (const double side : {1.0, -1.0}) {
    const Point2 sensor_W = map_W[a] + foot_m * along + side * height_m * across;
    if (std::abs((sensor_W - map_W[third]).norm() - scan_L[third].norm()) <= tolerance_m) {
      (void)poses.try_push_back(  // two sides, room for two
          {sensor_W.x(), sensor_W.y(), circular_mean_heading(scan_L, map_W, sensor_W)});
    }
  }
  return poses;
}

}  // namespace slamsensor::core
