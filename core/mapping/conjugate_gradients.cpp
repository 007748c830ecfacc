// The refinement of a map of many poses: a few conjugate gradients on the Gauss-Newton step of the reduced
// system (landmarks eliminated). Their preconditioner adds up the poses' own blocks, which see what stands
// about a pose, and the groups' equations, which see the map as a whole.
#include "core/mapping/sighting_graph.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

constexpr std::uint32_t kIterations = 4;  // of the conjugate gradients: the next scan's step goes on
constexpr double kDamping = 1e-6;         // of a pose's own block, in sightings

/// How the place of what stands `arm` from a pose follows (x, y, heading).
Point2 moved_by(const Eigen::Vector3d& step, const Point2& arm) noexcept {
  return {step.x() - step.z() * arm.y(), step.y() + step.z() * arm.x()};
}

/// The other way: what a pull on it means for the pose.
Eigen::Vector3d pull(const Point2& force, const Point2& arm) noexcept {
  return {force.x(), force.y(), arm.x() * force.y() - arm.y() * force.x()};
}

}  // namespace

/// Each sighting of the strong poses of the map: visit(sighting, unknown of its pose, arm from the pose to
/// what was seen).
template <typename Visit>
void SightingGraph::visit_strong(MapSlot map, Visit&& visit) noexcept {
  visit_poses([&](std::uint32_t place_of, const GraphPose& pose) {
    if (pose.map != map || pose.is_weak != 0) {
      return;
    }
    const Carrier carry(*this, pose.T_W_B);
    const Point2 from = pose.T_W_B.translation();
    for (std::uint32_t i = 0; i < pose.count; ++i) {
      GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
      if (s.landmark != kNone) {
        visit(s, unknowns_[place_of], Point2(carry(s) - from));
      }
    }
  });
}

/// Takes the steps of all poses of the map.
void SightingGraph::step_by_gradients(MapSlot map, std::uint32_t groups) noexcept {
  find_weak(map);
  linearise(map);
  double slope = precondition(map, groups);
  visit_poses([&](std::uint32_t at, const GraphPose&) { unknowns_[at].direction = unknowns_[at].guess; });
  for (std::uint32_t i = 0; i < kIterations && slope > 0.0; ++i) {
    const double bend = apply_system(map);
    if (!(bend > 0.0)) {
      break;
    }
    visit_poses([&](std::uint32_t at, const GraphPose&) {
      unknowns_[at].step += slope / bend * unknowns_[at].direction;
      unknowns_[at].residual -= slope / bend * unknowns_[at].image;
    });
    const double next = precondition(map, groups);
    visit_poses([&](std::uint32_t at, const GraphPose&) {
      unknowns_[at].direction = unknowns_[at].guess + next / slope * unknowns_[at].direction;
    });
    slope = next;
  }
  carry_weak(map);
}

/// Where the strong poses of the map say that landmarks stand, and with what weight.
void SightingGraph::sum_strong(MapSlot map) noexcept {
  for (std::uint32_t slot = 0; slot < landmarks_.size(); ++slot) {
    const GraphLandmark& l = landmarks_[slot];
    const auto weight = static_cast<double>(l.prior_weight);
    means_[slot] = {weight * Point2(static_cast<double>(l.prior_x_m), static_cast<double>(l.prior_y_m)),
                    weight, Point2::Zero()};
  }
  visit_poses([&](std::uint32_t, const GraphPose& pose) {
    if (pose.map == map && pose.is_weak == 0) {
      const Carrier carry(*this, pose.T_W_B);
      for (std::uint32_t i = 0; i < pose.count; ++i) {
        const GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
        if (s.landmark != kNone) {
          means_[s.landmark].place += static_cast<double>(s.weight) * carry(s);
          means_[s.landmark].weight += static_cast<double>(s.weight);
        }
      }
    }
  });
  for (std::uint32_t slot = 0; slot < landmarks_.size(); ++slot) {
    means_[slot].place /= std::max(1e-9, means_[slot].weight);
  }
}

/// A pose whose sightings hardly anything else shows would turn freely: it takes no part. What the poses that
/// were strong in the last step say decides; takes time in proportion to the sightings.
void SightingGraph::find_weak(MapSlot map) noexcept {
  sum_strong(map);
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    if (pose.map != map) {
      return;
    }
    std::uint32_t held = 0;
    for (std::uint32_t i = 0; i < pose.count; ++i) {
      const GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
      if (s.landmark != kNone) {
        const auto weight = static_cast<double>(s.weight);
        const double rest = means_[s.landmark].weight - (pose.is_weak == 0 ? weight : 0.0);
        held += rest > 0.0 && weight * rest / (rest + weight) > kHolds ? 1 : 0;
      }
    }
    poses_[at].is_weak = pose.is_anchor == 0 && held < kHeldMin ? 1 : 0;
  });
}

/// The slope of the sum of squares, the landmarks where the strong poses say, and each pose's own block of
/// the equations, inverted.
void SightingGraph::linearise(MapSlot map) noexcept {
  sum_strong(map);
  visit_poses([&](std::uint32_t at, const GraphPose&) { unknowns_[at] = PoseUnknown{}; });
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    if (pose.map != map || pose.is_anchor != 0 || pose.is_weak != 0) {
      return;
    }
    const Carrier carry(*this, pose.T_W_B);
    Eigen::Matrix3d block = kDamping * Eigen::Matrix3d::Identity();
    for (std::uint32_t i = 0; i < pose.count; ++i) {
      const GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
      if (s.landmark == kNone) {
        continue;
      }
      const Point2 seen_W = carry(s);
      const Point2 arm = seen_W - pose.T_W_B.translation();
      const auto weight = static_cast<double>(s.weight);
      Eigen::Matrix<double, 2, 3> J;
      J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
      unknowns_[at].residual -= weight * pull(seen_W - means_[s.landmark].place, arm);
      block += weight * (1.0 - weight / means_[s.landmark].weight) * J.transpose() * J;
    }
    unknowns_[at].inverse = block.inverse();
  });
}

/// image = S direction: what the direction does to the slope, the landmarks following. Returns direction .
/// image.
double SightingGraph::apply_system(MapSlot map) noexcept {
  for (std::uint32_t slot = 0; slot < landmarks_.size(); ++slot) {
    means_[slot].follows = Point2::Zero();
  }
  visit_strong(map, [&](const GraphSighting& s, const PoseUnknown& pose, const Point2& arm) {
    MeanPlace& mean = means_[s.landmark];
    mean.follows += static_cast<double>(s.weight) / mean.weight * moved_by(pose.direction, arm);
  });
  visit_poses([&](std::uint32_t at, const GraphPose&) { unknowns_[at].image.setZero(); });
  visit_strong(map, [&](const GraphSighting& s, PoseUnknown& pose, const Point2& arm) {
    const Point2 moved = moved_by(pose.direction, arm) - means_[s.landmark].follows;
    pose.image += static_cast<double>(s.weight) * pull(moved, arm);
  });
  double bend = 0.0;
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    PoseUnknown& unknown = unknowns_[at];
    unknown.image *= pose.is_anchor != 0 ? 0.0 : 1.0;
    bend += unknown.direction.dot(unknown.image);
  });
  return bend;
}

/// Weak poses go with the strong one before them.
void SightingGraph::carry_weak(MapSlot map) noexcept {
  Pose2 motion;
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    if (pose.map != map) {
      return;
    }
    Eigen::Vector3d& step = unknowns_[at].step;
    step.z() = std::clamp(step.z(), -kTurnMax_rad, kTurnMax_rad);
    if (pose.is_weak == 0) {
      const Pose2 after{pose.T_W_B.x_m + step.x(), pose.T_W_B.y_m + step.y(),
                        pose.T_W_B.heading_rad + step.z()};
      motion = after * pose.T_W_B.inverse();
    } else {
      const Pose2 after = motion * pose.T_W_B;
      step = {after.x_m - pose.T_W_B.x_m, after.y_m - pose.T_W_B.y_m,
              wrap_angle(after.heading_rad - pose.T_W_B.heading_rad)};
    }
  });
}

/// guess = (the poses' blocks + the groups' equations) on the residual. Returns residual . guess.
double SightingGraph::precondition(MapSlot map, std::uint32_t groups) noexcept {
  std::fill_n(step_.begin(), 3 * groups, 0.0);
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    if (pose.map == map) {
      const Point2 arm = pose.T_W_B.translation() - middles_[pose.group];
      const Eigen::Vector3d& r = unknowns_[at].residual;
      const Eigen::Vector3d pulled = pull(r.head<2>(), arm) + Eigen::Vector3d(0.0, 0.0, r.z());
      for (std::uint32_t i = 0; i < 3; ++i) {
        step_[3U * pose.group + i] += pulled(i);
      }
    }
  });
  solve(std::span(step_).first(3 * groups));
  double slope = 0.0;
  visit_poses([&](std::uint32_t at, const GraphPose& pose) {
    if (pose.map != map || pose.is_anchor != 0 || pose.is_weak != 0) {
      return;
    }
    const Eigen::Map<const Eigen::Vector3d> group(&step_[3U * pose.group]);
    const Point2 arm = pose.T_W_B.translation() - middles_[pose.group];
    PoseUnknown& unknown = unknowns_[at];
    unknown.guess = unknown.inverse * unknown.residual;
    unknown.guess.head<2>() += moved_by(group, arm);
    unknown.guess.z() += group.z();
    slope += unknown.residual.dot(unknown.guess);
  });
  return slope;
}

}  // namespace slamsensor::core
