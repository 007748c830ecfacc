#include "core/association/pose_scorer.hpp"

#include <cmath>

namespace slamsensor::core {
namespace {

constexpr double kRobustScaleShare =
    1.0 / 3.0;  // of the tolerance: the spread that true matches are expected to have

bool same_matches(const MatchList& a, const MatchList& b) noexcept {
  if (a.size() != b.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].scan != b[i].scan || a[i].map != b[i].map) {
      return false;
    }
  }
  return true;
}

}  // namespace

PoseScorer::PoseScorer(Arena& arena, const AssociationConfig& config,
                       std::uint32_t map_landmarks_max) noexcept
    : config_(config), claims_(arena, "association: claims", map_landmarks_max) {
}

std::uint32_t PoseScorer::count_inliers(const Pose2& pose_W, std::span<const Point2> scan_L,
                                        const MapView& map, std::uint32_t enough) const noexcept {
  const RigidMotion move(pose_W);
  std::uint32_t count = 0;
  auto left = static_cast<std::uint32_t>(scan_L.size());
  for (const Point2& p : scan_L) {
    if (count + left < enough) {
      return count;
    }
    --left;
    count += map.grid.nearest_within(move(p), config_.tolerance_m) != PointGrid::kNone ? 1U : 0U;
  }
  return count;
}

double PoseScorer::match(const Pose2& pose_W, std::span<const Point2> scan_L, const MapView& map,
                         MatchList& matches) noexcept {
  constexpr std::uint32_t kLoser = PointGrid::kNone;
  if (claims_.size() < map.positions_W.size()) {
    SLAMSENSOR_ASSERT(claims_.try_resize(map.positions_W.size()));
  }
  ++round_;
  const RigidMotion move(pose_W);
  matches.clear();
  for (std::uint32_t i = 0; i < scan_L.size(); ++i) {
    const Point2 seen_W = move(scan_L[i]);
    const std::uint32_t nearest = map.grid.nearest_within(seen_W, config_.tolerance_m);
    if (nearest == PointGrid::kNone) {
      continue;
    }
    const auto distance2 = static_cast<float>((seen_W - map.positions_W[nearest]).squaredNorm());
    Claim& claim = claims_[nearest];
    if (claim.round == round_) {
      if (claim.distance2_m2 <= distance2) {
        continue;
      }
      matches[claim.slot].map = kLoser;
    }
    if (!matches.try_push_back({i, nearest})) {
      break;
    }
    claim = {round_, static_cast<std::uint32_t>(matches.size() - 1), distance2};
  }
  double residual_m2 = 0.0;
  std::size_t kept = 0;
  for (const Match& m : matches) {
    if (m.map != kLoser) {
      residual_m2 += static_cast<double>(claims_[m.map].distance2_m2);
      matches[kept++] = m;
    }
  }
  matches.truncate(kept);
  return residual_m2;
}

std::optional<Candidate> PoseScorer::refine(const Pose2& pose_W, std::span<const Point2> scan_L,
                                            const MapView& map) noexcept {
  std::optional<Candidate> best;
  Candidate current;
  current.pose_W = pose_W;
  for (int round = 0; round <= kRefinements; ++round) {
    const MatchList before = current.matches;
    current.residual_m2 = match(current.pose_W, scan_L, map, current.matches);
    if (current.matches.size() < 3) {
      return best;
    }
    if (!best || current.matches_more_than(*best)) {
      best = current;
    }
    if (round > 0 && same_matches(before, current.matches)) {
      return best;
    }
    if (config_.fit == PoseFit::Robust) {
      current.pose_W = fit_pose_robust(current.pose_W, current.matches.span(), scan_L, map.positions_W,
                                       kRobustScaleShare * config_.tolerance_m);
    } else if (const auto fitted = fit_pose(current.matches.span(), scan_L, map.positions_W)) {
      current.pose_W = *fitted;
    } else {
      return best;
    }
  }
  return best;
}

}  // namespace slamsensor::core
