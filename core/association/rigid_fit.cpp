#include "core/association/rigid_fit.hpp"

#include <Eigen/LU>

#include <cmath>

namespace slamsensor::core {

namespace {

/// Weighted closed-form fit; `weight_of(match)` is not negative.
template <typename WeightOf>
std::optional<Pose2> fit_weighted(std::span<const Match> matches, std::span<const Point2> scan_L,
                                  std::span<const Point2> map_W, WeightOf&& weight_of) noexcept {
  Point2 mean_L = Point2::Zero();
  Point2 mean_W = Point2::Zero();
  double total = 0.0;
  for (const Match& m : matches) {
    const double weight = weight_of(m);
    mean_L += weight * scan_L[m.scan];
    mean_W += weight * map_W[m.map];
    total += weight;
  }
  if (matches.size() < 2 || total <= 0.0) {
    return std::nullopt;
  }
  mean_L /= total;
  mean_W /= total;
  double dot = 0.0;
  double cross = 0.0;
  for (const Match& m : matches) {
    const double weight = weight_of(m);
    const Point2 l = scan_L[m.scan] - mean_L;
    const Point2 w = map_W[m.map] - mean_W;
    dot += weight * l.dot(w);
    cross += weight * (l.x() * w.y() - l.y() * w.x());
  }
  if (dot == 0.0 && cross == 0.0) {
    return std::nullopt;
  }
  const double heading_rad = std::atan2(cross, dot);
  const Point2 t = mean_W - Pose2{0.0, 0.0, heading_rad} * mean_L;
  return Pose2{t.x(), t.y(), heading_rad};
}

}  // namespace

std::optional<Pose2> fit_pose(std::span<const Match> matches, std::span<const Point2> scan_L,
                              std::span<const Point2> map_W) noexcept {
  return fit_weighted(matches, scan_L, map_W, [](const Match&) { return 1.0; });
}

Pose2 fit_pose_robust(const Pose2& start, std::span<const Match> matches, std::span<const Point2> scan_L,
                      std::span<const Point2> map_W, double scale_m) noexcept {
  constexpr int kRounds = 5;
  Pose2 pose = start;
  for (int round = 0; round < kRounds; ++round) {
    const RigidMotion move(pose);
    const auto fitted = fit_weighted(matches, scan_L, map_W, [&](const Match& m) {
      const double r = (move(scan_L[m.scan]) - map_W[m.map]).squaredNorm() / (scale_m * scale_m);
      return 1.0 / ((1.0 + r) * (1.0 + r));
    });
    if (!fitted) {
      return pose;
    }
    pose = *fitted;
  }
  return pose;
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
