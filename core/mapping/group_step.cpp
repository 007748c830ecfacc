// The coarse level of the refinement: SightingGraph::group_step. Poses of a map are moved in groups, each as
// a rigid body about its middle, by the exact Gauss-Newton step of the reduced system (landmarks eliminated).
// What a closed loop shows is so spread over the whole loop at once, where moving pose by pose would take as
// many rounds as there are poses.
#include "core/mapping/sighting_graph.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

// Sightings of one scan err alike, so that small gains in the sum of squares are no evidence: a step has to
// gain this many variances of a sighting. A closed loop gains thousands.
constexpr double kGainMin = 100.0;
constexpr double kHold = 1e9;  // information that holds the frame of a map
constexpr double kDamping = 1e-6;
constexpr double kTurnMax_rad = 0.3;   // of a step: beyond, the linearisation says nothing
constexpr double kOffsetPrior = 2.0;   // sightings' worth of belief that there is no offset
constexpr double kOffsetSigmas = 4.0;  // by which an offset has to stand out before it is used
constexpr double kOffsetMax_m = 0.5;
constexpr double kOffsetStep_m = 0.1;     // at a time: the association has yet to follow
constexpr double kOffsetMin_m = 0.08;     // a smaller step from none is taken for what errors have in common
constexpr double kOffsetWorth_m = 0.002;  // a smaller change is not worth moving all landmarks

}  // namespace

void SightingGraph::group_step(MapSlot map, double sigma_m) noexcept {
  const std::uint32_t groups = make_groups(map);
  if (groups < 2) {
    return;
  }
  std::fill(system_.begin(), system_.end(), 0.0);
  step_.fill(0.0);
  for (std::uint32_t slot = 0; slot < landmarks_.size(); ++slot) {
    if (used_[slot] != 0 && landmarks_[slot].map == map && landmarks_[slot].sightings != kNone) {
      add_landmark_to_system(slot, 3 * groups);
    }
  }
  const std::uint32_t unknowns = 3 * groups + 1;
  system(unknowns - 1, unknowns - 1) += kOffsetPrior;
  step_[unknowns - 1] -= kOffsetPrior * offset_m_;
  hold_frame(map, groups);
  if (!factorise(unknowns)) {
    return;
  }
  const std::array<double, kUnknownsMax> slope = step_;
  solve(std::span(step_).first(unknowns));
  find_drift(map, groups);
  double gain = 0.0;  // of the step: by how much it lowers the sum of squares
  for (std::size_t i = 0; i < std::size_t{unknowns}; ++i) {
    gain += slope[i] * step_[i];
  }
  if (gain < kGainMin * sigma_m * sigma_m) {
    return;
  }
  // The offset is found where each pose is a group of its own: larger groups would bend to take it up.
  if (groups < kGroupsMax) {
    step_offset(step_[unknowns - 1], sigma_m / system(unknowns - 1, unknowns - 1));
  }
  move_groups(map);
  sum_anew();
}

/// Groups of consecutive poses, and their middles. Returns how many.
std::uint32_t SightingGraph::make_groups(MapSlot map) noexcept {
  std::uint32_t poses = 0;
  visit_poses([&](std::uint32_t, const GraphPose& pose) { poses += pose.map == map ? 1 : 0; });
  const std::uint32_t groups = std::min(kGroupsMax, poses / kGroupPosesMin);
  if (groups < 2) {
    return groups;
  }
  middles_.fill(Point2::Zero());
  members_.fill(0.0);
  std::uint32_t number = 0;
  visit_poses([&](std::uint32_t place_of, const GraphPose& pose) {
    if (pose.map == map) {
      const auto group = static_cast<std::uint16_t>(std::uint64_t{number++} * groups / poses);
      poses_[place_of].group = group;
      middles_[group] += pose.T_W_B.translation();
      members_[group] += 1.0;
    }
  });
  for (std::uint32_t g = 0; g < groups; ++g) {
    middles_[g] /= members_[g];
  }
  return groups;
}

/// The landmark's part of the normal equations: sum of w J^T J over its sightings, less what the landmark
/// itself takes up by moving, (sum w J)^T (sum w J) / (sum w).
void SightingGraph::add_landmark_to_system(std::uint32_t slot, std::uint32_t offset_at) noexcept {
  const GraphLandmark& l = landmarks_[slot];
  Shares shares;
  Point2 sum_along = Point2::Zero();
  for (std::uint32_t s = l.sightings; s != kNone; s = sightings_[s].next) {
    const GraphSighting& sighting = sightings_[s];
    const GraphPose& pose = poses_[sighting.pose];
    const Point2 point_L(static_cast<double>(sighting.x_m), static_cast<double>(sighting.y_m));
    const Point2 q = pose.T_W_B * body_point(point_L);
    const Point2 residual = q - positions_[slot];
    const Point2 arm = q - middles_[pose.group];
    const auto weight = static_cast<double>(sighting.weight);
    Eigen::Matrix<double, 2, 3> J;
    J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    const std::uint32_t at = 3U * pose.group;
    const Eigen::Matrix3d own = weight * J.transpose() * J;
    const Eigen::Vector3d slope = weight * J.transpose() * residual;
    for (std::uint32_t i = 0; i < 3; ++i) {
      step_[at + i] -= slope(i);
      for (std::uint32_t j = 0; j < 3; ++j) {
        system(at + i, at + j) += own(i, j);
      }
    }
    auto* share = std::find_if(shares.begin(), shares.end(),
                               [&](const Share& other) { return other.group == pose.group; });
    if (share == shares.end()) {
      SLAMSENSOR_ASSERT(shares.try_push_back({pose.group, {}}));
      share = &shares.back();
      share->sum_J.setZero();
    }
    share->sum_J += weight * J;
    const double range_m = point_L.norm();
    if (range_m > 0.0) {  // along the ray, as the offset moves it
      const Point2 along =
          (pose.T_W_B * (T_B_L_ * Point2(point_L / range_m))) - (pose.T_W_B * T_B_L_.translation());
      sum_along += weight * along;
      const Eigen::Vector3d cross = weight * J.transpose() * along;
      step_[offset_at] -= weight * along.dot(residual);
      system(offset_at, offset_at) += weight;
      for (std::uint32_t i = 0; i < 3; ++i) {
        system(offset_at, at + i) += cross(i);
      }
    }
  }
  system(offset_at, offset_at) -= sum_along.squaredNorm() / l.sum_weight;
  for (const Share& a : shares) {
    const Eigen::Vector3d cross = a.sum_J.transpose() * sum_along / l.sum_weight;
    for (std::uint32_t i = 0; i < 3; ++i) {
      system(offset_at, 3 * a.group + i) -= cross(i);
    }
    for (const Share& b : shares) {
      const Eigen::Matrix3d common = a.sum_J.transpose() * b.sum_J / l.sum_weight;
      for (std::uint32_t i = 0; i < 3; ++i) {
        for (std::uint32_t j = 0; j < 3; ++j) {
          system(3 * a.group + i, 3 * b.group + j) -= common(i, j);
        }
      }
    }
  }
}

/// The first scan holds the frame of its map; where it is kept no more, the priors that it left do.
void SightingGraph::hold_frame(MapSlot map, std::uint32_t groups) noexcept {
  bool has_anchor = false;
  visit_poses([&](std::uint32_t, const GraphPose& pose) {
    if (pose.map == map && pose.is_anchor != 0) {
      has_anchor = true;
      for (std::uint32_t i = 0; i < 3; ++i) {
        system(3U * pose.group + i, 3U * pose.group + i) += kHold;
      }
    }
  });
  for (std::uint32_t i = 0; i < 3 * groups; ++i) {
    system(i, i) += has_anchor ? kDamping : kDamping * (1.0 + system(i, i));
  }
}

/// Cholesky factor in place, in the lower triangle. False when the equations are not positive definite.
bool SightingGraph::factorise(std::uint32_t unknowns) noexcept {
  for (std::uint32_t j = 0; j < unknowns; ++j) {
    double diagonal = system(j, j);
    for (std::uint32_t k = 0; k < j; ++k) {
      diagonal -= system(j, k) * system(j, k);
    }
    if (!(diagonal > 0.0)) {
      return false;
    }
    diagonal = std::sqrt(diagonal);
    system(j, j) = diagonal;
    for (std::uint32_t i = j + 1; i < unknowns; ++i) {
      double value = system(i, j);
      for (std::uint32_t k = 0; k < j; ++k) {
        value -= system(i, k) * system(j, k);
      }
      system(i, j) = value / diagonal;
    }
  }
  return true;
}

void SightingGraph::solve(std::span<double> x) const noexcept {
  const auto unknowns = static_cast<std::uint32_t>(x.size());
  for (std::uint32_t i = 0; i < unknowns; ++i) {
    for (std::uint32_t k = 0; k < i; ++k) {
      x[i] -= system(i, k) * x[k];
    }
    x[i] /= system(i, i);
  }
  for (std::uint32_t i = unknowns; i-- > 0;) {
    for (std::uint32_t k = i + 1; k < unknowns; ++k) {
      x[i] -= system(k, i) * x[k];
    }
    x[i] /= system(i, i);
  }
}

/// The variance of a group is its block of the inverse.
void SightingGraph::find_drift(MapSlot map, std::uint32_t groups) noexcept {
  drift_map_ = map;
  std::array<double, kUnknownsMax> column{};
  const std::uint32_t unknowns = 3 * groups + 1;
  for (std::uint32_t c = 0; c < 3 * groups; ++c) {
    // Only the part of the inverse below and at `c` is needed: forward from `c`, and the norms of what is
    // left.
    std::fill_n(column.begin(), unknowns, 0.0);
    column[c] = 1.0;
    solve(std::span(column).first(unknowns));
    for (std::uint32_t i = 0; i < 3; ++i) {
      drift_[c / 3](i, c % 3) = column[c / 3 * 3 + i];
    }
  }
}

void SightingGraph::move_groups(MapSlot map) noexcept {
  visit_poses([&](std::uint32_t place_of, const GraphPose& pose) {
    if (pose.map != map || pose.is_anchor != 0) {
      return;
    }
    const std::size_t at = std::size_t{3} * pose.group;
    const Point2& middle = middles_[pose.group];
    const double turn_rad = std::clamp(step_[at + 2], -kTurnMax_rad, kTurnMax_rad);
    const Pose2 turn{0.0, 0.0, turn_rad};
    const Point2 moved =
        middle + Point2(step_[at], step_[at + 1]) + turn * Point2(pose.T_W_B.translation() - middle);
    poses_[place_of].T_W_B = {moved.x(), moved.y(), wrap_angle(pose.T_W_B.heading_rad + turn_rad)};
  });
}

/// The offset as it follows from all sightings together with the poses; `sigma_m` is its own 1 sigma.
void SightingGraph::step_offset(double step_m, double sigma_m) noexcept {
  const double worth_m = offset_m_ == 0.0 ? std::max(kOffsetMin_m, kOffsetSigmas * sigma_m) : kOffsetWorth_m;
  if (std::abs(step_m) >= worth_m) {
    offset_m_ = std::clamp(offset_m_ + std::clamp(step_m, -kOffsetStep_m, kOffsetStep_m), -kOffsetMax_m,
                           kOffsetMax_m);
  }
}

}  // namespace slamsensor::core
