#pragma once

#include "core/geometry/pose2.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// A landmark of the scan that was found in the map. The first element of a sorted list is the lowest `scan`.
struct Match {
  std::uint32_t scan = 0;  ///< index into the scan's landmarks
  std::uint32_t map = 0;   ///< index into the map's landmarks
};

/// The pose T_W_L that minimises the sum of squared distances between matched landmarks (closed form; Umeyama
/// 1991 without scale, in the plane). None for fewer than two matches or when all scan landmarks coincide.
[[nodiscard]] std::optional<Pose2> fit_pose(std::span<const Match> matches, std::span<const Point2> scan_L,
                                            std::span<const Point2> map_W) noexcept;

/// The pose near `start` that minimises a sum over the matches which a wrong match cannot pull far: distances
/// well below `scale_m` count as in fit_pose, those well above hardly (Geman-McClure weights, iterated
/// reweighted least squares). `start` itself when no fit is possible.
[[nodiscard]] Pose2 fit_pose_robust(const Pose2& start, std::span<const Match> matches,
                                    std::span<const Point2> scan_L, std::span<const Point2> map_W,
                                    double scale_m) noexcept;

/// Covariance of (x m, y m, heading rad) in W of a pose fitted to `matches`: the spread of their residuals,
/// carried through the geometry of the matched landmarks, sigma^2 (J^T J)^-1. `prior_sigma_m`, the spread to
/// be expected before any residual is seen, counts as three observations, so that few or lucky matches do not
/// look perfect.
[[nodiscard]] Eigen::Matrix3d pose_covariance(const Pose2& pose_W, std::span<const Match> matches,
                                              std::span<const Point2> scan_L, std::span<const Point2> map_W,
                                              double prior_sigma_m) noexcept;

}  // namespace slamsensor::core
