#include "core/association/candidate.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {

void Candidate::name_triangle(std::span<const std::uint32_t, 3> corners) noexcept {
  std::size_t named = 0;
  const auto name = [&](const Match& match) {
    auto* const end = triangle.begin() + named;
    if (named < 3 && std::find(triangle.begin(), end, match.map) == end) {
      triangle[named++] = match.map;
    }
  };
  for (const Match& match : matches) {
    if (std::find(corners.begin(), corners.end(), match.scan) != corners.end()) {
      name(match);
    }
  }
  std::for_each(matches.begin(), matches.end(), name);
}

ScanMoments::ScanMoments(std::span<const Point2> scan_L) noexcept {
  for (const Point2& p : scan_L) {
    mean_L_ += p;
    mean_square_m2_ += p.squaredNorm();
  }
  const double count = std::max<double>(1.0, static_cast<double>(scan_L.size()));
  mean_L_ /= count;
  mean_square_m2_ /= count;
}

double ScanMoments::displacement_m(const Pose2& a, const Pose2& b) const noexcept {
  // Mean over p of |(R_a - R_b) p + t_a - t_b|^2, expanded.
  const Point2 shift = a.translation() - b.translation();
  const Point2 turned_mean = (a * mean_L_ - a.translation()) - (b * mean_L_ - b.translation());
  const double half_sine = std::sin(0.5 * (a.heading_rad - b.heading_rad));
  const double square =
      shift.squaredNorm() + 2.0 * shift.dot(turned_mean) + 4.0 * half_sine * half_sine * mean_square_m2_;
  return std::sqrt(std::max(square, 0.0));
}

}  // namespace slamsensor::core
