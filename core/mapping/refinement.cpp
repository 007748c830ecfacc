// The refinement's step: SightingGraph::refine. As long as each pose can be a group of its own, it is the
// exact Gauss-Newton step of the reduced system (landmarks eliminated), the offset of near faces with it.
// Later the groups, of consecutive poses, are the coarse level of the conjugate gradients: what a closed loop
// shows is so spread over the whole loop at once, where moving pose by pose would take as many rounds as
// there are poses.
#include "core/mapping/sighting_graph.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

constexpr double kGroupGap_m = 30.0;  // between poses that follow each other: farther is a kidnap
constexpr double kHold = 1e9;         // information that holds the frame of a map
constexpr double kDamping = 1e-6;
constexpr double kOffsetPrior = 2.0;   // sightings' worth of belief that there is no offset
constexpr double kOffsetSigmas = 4.0;  // by which an offset has to stand out before it is used
constexpr double kOffsetMax_m = 0.5;
constexpr double kOffsetStep_m = 0.1;     // at a time: the association has yet to follow
constexpr double kOffsetMin_m = 0.08;     // a smaller step from none is taken for what errors have in common
constexpr double kOffsetWorth_m = 0.002;  // a smaller change is not worth moving all landmarks
constexpr double kOffsetFound_m = 0.04;   // 1 sigma

}  // namespace

void SightingGraph::refine(MapSlot map, double sigma_m) noexcept {
  const std::uint32_t groups = make_groups(map);
  if (groups < 2) {
    return;
  }
  std::fill(system_.begin(), system_.end(), 0.0);
  step_.fill(0.0);
  range_sum_m_ = range_count_ = 0.0;
  for (std::uint32_t slot = 0; slot < landmarks_.size(); ++slot) {
    if (used_[slot] != kFree && landmarks_[slot].map == map && landmarks_[slot].sightings != kNone) {
      add_landmark_to_system(slot, 3 * groups);
    }
  }
  const std::uint32_t unknowns = 3 * groups + 1;
  system(unknowns - 1, unknowns - 1) += kOffsetPrior;
  step_[unknowns - 1] -= kOffsetPrior * (offset_m_ - expected_offset_m_);
  hold_frame(map, groups);
  if (!factorise(unknowns)) {
    return;
  }
  double offset_step_m = 0.0;
  if (std::all_of(members_.begin(), members_.begin() + groups,
                  [](double members) { return members == 1.0; })) {
    offset_step_m = step_each(map, groups, sigma_m);
  } else {
    step_by_gradients(map, groups);
  }
  find_drift(map, groups);
  const double offset_m = offset_m_;
  const double before = squares(map);
  offset_m_ = std::clamp(offset_m_ + offset_step_m, -kOffsetMax_m, kOffsetMax_m);
  move_poses(map, 1.0);
  sum_anew();
  if (squares(map) > before) {  // beyond what the linearised equations say
    offset_m_ = offset_m;
    move_poses(map, -1.0);
    sum_anew();
  }
}

/// The step of each pose by itself, and the offset's, which is returned: larger groups would bend to take the
/// offset up. It is the last unknown, so that the step of the poses without it is that of the leading part of
/// the equations.
double SightingGraph::step_each(MapSlot map, std::uint32_t groups, double sigma_m) noexcept {
  const std::uint32_t unknowns = 3 * groups + 1;
  const std::array<double, kUnknownsMax> slope = step_;
  solve(std::span(step_).first(unknowns));
  const double offset_sigma_m = sigma_m / system(unknowns - 1, unknowns - 1);
  double offset_step_m = std::clamp(step_[unknowns - 1], -kOffsetStep_m, kOffsetStep_m);
  is_offset_found_ = is_offset_found_ || offset_sigma_m <= kOffsetFound_m;
  if (std::abs(step_[unknowns - 1]) < offset_worth_m(offset_sigma_m)) {
    offset_step_m = 0.0;
    step_ = slope;
    solve(std::span(step_).first(3 * groups));
  }
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    if (pose.map == map) {
      const std::size_t first = std::size_t{3} * pose.group;
      unknowns_[at].step = {step_[first], step_[first + 1],
                            std::clamp(step_[first + 2], -kTurnMax_rad, kTurnMax_rad)};
      unknowns_[at].step *= pose.is_anchor != 0 ? 0.0 : 1.0;
    }
  });
  return offset_step_m;
}

/// The weighted sum of squares of the sightings of the map's strong poses about their landmarks (m^2).
double SightingGraph::squares(MapSlot map) const noexcept {
  double sum = 0.0;
  visit_poses([&](std::uint32_t, const GraphPose& pose) {
    const Carrier carry(*this, pose.T_W_B);
    for (std::uint32_t i = 0; pose.map == map && pose.is_weak == 0 && i < pose.count; ++i) {
      const GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
      if (s.landmark != kNone) {
        sum += static_cast<double>(s.weight) * (carry(s) - positions_[s.landmark]).squaredNorm();
      }
    }
  });
  return sum;
}

/// Whether two poses that follow each other are parts of one rigid body: not where one local map ends and
/// another begins, and not where the carrier was taken elsewhere between them.
bool SightingGraph::hang_together(const GraphPose& before, const GraphPose& pose) noexcept {
  return before.chain == pose.chain &&
         (before.T_W_B.translation() - pose.T_W_B.translation()).norm() <= kGroupGap_m;
}

/// Groups of consecutive poses, and their middles. Returns how many.
std::uint32_t SightingGraph::make_groups(MapSlot map) noexcept {
  std::uint32_t poses = 0;
  std::uint32_t seams = 0;
  const GraphPose* last = nullptr;
  visit_poses([&](std::uint32_t, const GraphPose& pose) {
    if (pose.map == map) {
      ++poses;
      seams += last != nullptr && !hang_together(*last, pose) ? 1 : 0;
      last = &pose;
    }
  });
  if (poses < 2) {
    return 0;
  }
  // At most half of the groups end at seams, if there are too many, at the latest ones.
  const std::uint32_t most_seams = std::min(seams, kGroupsMax / 2);
  const std::uint32_t size = (poses + kGroupsMax - most_seams - 1) / (kGroupsMax - most_seams);
  middles_.fill(Point2::Zero());
  members_.fill(0.0);
  path_m_ = 0.0;
  std::uint32_t groups = 0;
  std::uint32_t seams_left = seams;
  last = nullptr;
  visit_poses([&](std::uint32_t place_of, const GraphPose& pose) {
    if (pose.map != map) {
      return;
    }
    const bool is_seam = last != nullptr && !hang_together(*last, pose);
    const bool ends = groups == 0 || (is_seam && seams_left <= most_seams) || members_[groups - 1] >= size;
    groups += ends && groups < kGroupsMax ? 1 : 0;
    seams_left -= is_seam ? 1 : 0;
    poses_[place_of].group = static_cast<std::uint16_t>(groups - 1);
    middles_[groups - 1] += pose.T_W_B.translation();
    path_m_ += ends || last == nullptr ? 0.0 : (pose.T_W_B.translation() - last->T_W_B.translation()).norm();
    members_[groups - 1] += 1.0;
    last = &pose;
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
    const RigidMotion T_W_B(pose.T_W_B);
    const Point2 q = T_W_B(body_point(point_L));
    const Point2 residual = q - positions_[slot];
    const Point2 arm = q - middles_[pose.group];
    const auto weight = static_cast<double>(sighting.weight);
    Eigen::Matrix<double, 2, 3> J;
    J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    const std::uint32_t at = 3U * pose.group;
    const Eigen::Matrix3d own = weight * J.transpose() * J;
    const Eigen::Vector3d slope = weight * J.transpose() * residual;
    for (std::uint32_t k = 0; k < 9; ++k) {
      system(at + k / 3, at + k % 3) += own(k / 3, k % 3);
      step_[at + k / 3] -= k % 3 == 0 ? slope(k / 3) : 0.0;
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
    range_sum_m_ += range_m;
    range_count_ += 1.0;
    if (range_m > 0.0) {  // along the ray, as the offset moves it
      const Point2 along = T_W_B(T_B_L_ * Point2(point_L / range_m)) - T_W_B(T_B_L_.translation());
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

/// The variance of a group is its block of the inverse. A group is no rigid body but a chain of poses, as
/// many links longer as its path is longer than what a scan sees.
void SightingGraph::find_drift(MapSlot map, std::uint32_t groups) noexcept {
  MapDrift& drift = drifts_[map == drifts_[0].map ? 0 : 1];
  drift.map = map;
  const double range_m = range_sum_m_ / std::max(1.0, range_count_);
  const double bend = 1.0 + path_m_ / groups / std::max(1.0, range_m);
  std::array<double, kUnknownsMax> column{};
  const std::uint32_t unknowns = 3 * groups + 1;
  for (std::uint32_t c = 0; c < 3 * groups; ++c) {
    // Only the part of the inverse below and at `c` is needed: forward from `c`, and the norms of what is
    // left.
    std::fill_n(column.begin(), unknowns, 0.0);
    column[c] = 1.0;
    solve(std::span(column).first(unknowns));
    for (std::uint32_t i = 0; i < 3; ++i) {
      drift.groups[c / 3](i, c % 3) = bend * column[c / 3 * 3 + i];
    }
  }
}

void SightingGraph::move_poses(MapSlot map, double sign) noexcept {
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    if (pose.map == map) {
      Pose2& T_W_B = poses_[at].T_W_B;
      T_W_B.x_m += sign * unknowns_[at].step.x();
      T_W_B.y_m += sign * unknowns_[at].step.y();
      T_W_B.heading_rad = wrap_angle(T_W_B.heading_rad + sign * unknowns_[at].step.z());
    }
  });
}

/// The least step of the offset that is taken; `sigma_m` is its own 1 sigma.
double SightingGraph::offset_worth_m(double sigma_m) const noexcept {
  return offset_m_ == 0.0 ? std::max(kOffsetMin_m, kOffsetSigmas * sigma_m) : kOffsetWorth_m;
}

}  // namespace slamsensor::core
