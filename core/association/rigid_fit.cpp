#include "core/association/rigid_fit.hpp"

#include <Eigen/LU>

#include <cmath>

namespace slamsensor::core {

namespace {

/// Weighted closed-form fit in one pass, about the first match; `weight_of(scan point, map point)` is not
/// negative.
template <typename WeightOf>
std::optional<RigidMotion> fit_weighted(std::span<const Match> matches, std::span<const Point2> scan_L,
                                        std::span<const Point2> map_W, WeightOf&& weight_of) noexcept {
  if (matches.size() < 2) {
    return std::nullopt;
  }
  const Point2& first_L = scan_L[matches[0].scan];
  const Point2& first_W = map_W[matches[0].map];
  double total = 0.0;
  double lx = 0.0, ly = 0.0, wx = 0.0, wy = 0.0;  // weighted sums
  double dot = 0.0;
  double cross = 0.0;
  for (const Match& m : matches) {
    const Point2& p = scan_L[m.scan];
    const Point2& q = map_W[m.map];
    const double weight = weight_of(p, q);
    const double px = p.x() - first_L.x();
    const double py = p.y() - first_L.y();
    const double qx = q.x() - first_W.x();
    const double qy = q.y() - first_W.y();
    total += weight;
    lx += weight * px;
    ly += weight * py;
    wx += weight * qx;
    wy += weight * qy;
    dot += weight * (px * qx + py * qy);
    cross += weight * (px * qy - py * qx);
  }
  if (total <= 0.0) {
    return std::nullopt;
  }
  dot -= (lx * wx + ly * wy) / total;
  cross -= (lx * wy - ly * wx) / total;
  if (dot == 0.0 && cross == 0.0) {
    return std::nullopt;
  }
  return RigidMotion::from_direction(first_L + Point2(lx, ly) / total, first_W + Point2(wx, wy) / total, dot,
                                     cross);
}

}  // namespace

std::optional<Pose2> fit_pose(std::span<const Match> matches, std::span<const Point2> scan_L,
                              std::span<const Point2> map_W) noexcept {
  const auto fitted = fit_weighted(matches, scan_L, map_W, [](const Point2&, const Point2&) { return 1.0; });
  return fitted ? std::optional(fitted->pose()) : std::nullopt;
}

Pose2 fit_pose_robust(const Pose2& start, std::span<const Match> matches, std::span<const Point2> scan_L,
                      std::span<const Point2> map_W, double scale_m) noexcept {
  constexpr int kRounds = 5;
  RigidMotion move(start);
  for (int round = 0; round < kRounds; ++round) {
    const auto fitted = fit_weighted(matches, scan_L, map_W, [&](const Point2& p, const Point2& q) {
      const Point2 seen = move(p);
      const double dx = seen.x() - q.x();
      const double dy = seen.y() - q.y();
      const double r = (dx * dx + dy * dy) / (scale_m * scale_m);
      return 1.0 / ((1.0 + r) * (1.0 + r));
    });
    if (!fitted) {
      break;
    }
    move = *fitted;
  }
  return move.pose();
}

Eigen::Matrix3d pose_covariance(const Pose2& pose_W, std::span<const Match> matches,
                                std::span<const Point2> scan_L, std::span<const Point2> map_W,
                                double prior_sigma_m) noexcept {
  constexpr double kPriorObservations = 3.0;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double residual2 = 0.0;
  for (const Match& m : matches) {
    const Point2 seen_W = pose_W * scan_L[m.scan];
    residual2 += (seen_W - map_W[m.map]).squaredNorm();
    const Point2 arm = seen_W - pose_W.translation();  // d(seen)/d(heading) = (-arm.y, arm.x)
    information(0, 0) += 1.0;
    information(1, 1) += 1.0;
    information(0, 2) -= arm.y();
    information(1, 2) += arm.x();
    information(2, 2) += arm.squaredNorm();
  }
  information(2, 0) = information(0, 2);
  information(2, 1) = information(1, 2);
  const double freedom = std::max(0.0, 2.0 * static_cast<double>(matches.size()) - 3.0);
  const double sigma2 =
      (residual2 + kPriorObservations * prior_sigma_m * prior_sigma_m) / (freedom + kPriorObservations);
  Eigen::Matrix3d inverse;
  bool invertible = false;
  information.computeInverseWithCheck(inverse, invertible);
  if (!invertible) {  // fewer than two distinct landmarks: nothing is known
    return Eigen::Matrix3d::Identity() * 1e6;
  }
  return sigma2 * inverse;
}

}  // namespace slamsensor::core
