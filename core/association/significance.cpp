#include "core/association/significance.hpp"

#include "core/association/false_alarms.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::core {
namespace {

// The neighbourhood over which the map's density is taken, in tolerances: wide enough to hold several
// landmarks, narrow enough to tell a thicket from a clearing.
constexpr double kDensityRadiusTolerances = 15.0;

}  // namespace

double chance_match(const Pose2& pose_W, std::span<const Point2> scan_L, const MapView& map,
                    double tolerance_m) noexcept {
  if (scan_L.empty()) {
    return 0.0;
  }
  const double radius_m = kDensityRadiusTolerances * tolerance_m;
  const double share = (tolerance_m * tolerance_m) / (radius_m * radius_m);
  const RigidMotion move(pose_W);
  double sum = 0.0;
  for (const Point2& p : scan_L) {
    sum += std::min(1.0, share * map.grid.count_within(move(p), radius_m));
  }
  return sum / static_cast<double>(scan_L.size());
}

double log10_chance(const Candidate& candidate, std::span<const Point2> scan_L, const MapView& map,
                    double tolerance_m) noexcept {
  std::array<double, kScanLandmarksMax> shares;  // NOLINT: the part that is read is written first
  const RigidMotion move(candidate.pose_W);
  for (std::size_t i = 0; i < candidate.matches.size(); ++i) {
    const Match& m = candidate.matches[i];
    const double distance2 = (move(scan_L[m.scan]) - map.positions_W[m.map]).squaredNorm();
    shares[i] = std::min(1.0, distance2 / (tolerance_m * tolerance_m));
  }
  const std::span<double> used = std::span(shares).first(candidate.matches.size());
  std::sort(used.begin(), used.end());
  return log10_chance_of_matches(static_cast<std::uint32_t>(scan_L.size()), used,
                                 chance_match(candidate.pose_W, scan_L, map, tolerance_m));
}

}  // namespace slamsensor::core
