#include "core/association/acceptance.hpp"

#include "core/association/false_alarms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace slamsensor::core {
namespace {

// Matches within the tolerance are expected to have this spread, as a share of it, before any residual is
// seen.
constexpr double kPriorSigmaShare = 1.0 / 3.0;

/// How many landmarks of the scan each of two poses explains better.
struct Comparison {
  std::uint32_t best = 0;
  std::uint32_t rival = 0;
};

Comparison compare(const Candidate& best, const Candidate& rival, std::span<const Point2> scan_L,
                   std::span<const Point2> map_W) noexcept {
  constexpr double kUnexplained = std::numeric_limits<double>::infinity();
  std::array<double, kScanLandmarksMax> best_m;   // NOLINT: written before it is read
  std::array<double, kScanLandmarksMax> rival_m;  // NOLINT
  const auto fill = [&](const Candidate& candidate, std::span<double> distance_m) {
    std::fill(distance_m.begin(), distance_m.end(), kUnexplained);
    const RigidMotion move(candidate.pose_W);
    for (const Match& m : candidate.matches) {
      distance_m[m.scan] = (move(scan_L[m.scan]) - map_W[m.map]).norm();
    }
  };
  fill(best, std::span(best_m).first(scan_L.size()));
  fill(rival, std::span(rival_m).first(scan_L.size()));
  Comparison wins;
  for (std::size_t i = 0; i < scan_L.size(); ++i) {
    wins.best += best_m[i] < rival_m[i] ? 1 : 0;
    wins.rival += rival_m[i] < best_m[i] ? 1 : 0;
  }
  return wins;
}

bool beats(const Candidate& best, const Candidate& rival, std::span<const Point2> scan_L,
           std::span<const Point2> map_W, const AcceptanceConfig& config) noexcept {
  const Comparison wins = compare(best, rival, scan_L, map_W);
  return log10_rival_chance(wins.best, wins.rival) <= std::log10(config.ambiguity_risk);
}

/// Whether three sigma of the pose stay within what is called right.
bool precise(const Candidate& candidate, std::span<const Point2> scan_L, std::span<const Point2> map_W,
             double tolerance_m, const AcceptanceConfig& config) noexcept {
  const Eigen::Matrix3d covariance = candidate_covariance(candidate, scan_L, map_W, tolerance_m);
  const double half_trace = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double half_gap = 0.5 * (covariance(0, 0) - covariance(1, 1));
  const double longest =
      half_trace + std::hypot(half_gap, covariance(0, 1));  // larger eigenvalue of the position
  return 3.0 * std::sqrt(longest) <= config.elsewhere_m &&
         3.0 * std::sqrt(covariance(2, 2)) <= config.elsewhere_rad;
}

}  // namespace

Eigen::Matrix3d candidate_covariance(const Candidate& candidate, std::span<const Point2> scan_L,
                                     std::span<const Point2> map_W, double tolerance_m) noexcept {
  return pose_covariance(candidate.pose_W, candidate.matches.span(), scan_L, map_W,
                         kPriorSigmaShare * tolerance_m);
}

bool elsewhere(const Pose2& a, const Pose2& b, const AcceptanceConfig& config) noexcept {
  return (a.translation() - b.translation()).norm() > config.elsewhere_m ||
         std::abs(wrap_angle(a.heading_rad - b.heading_rad)) > config.elsewhere_rad;
}

Verdict judge(const Candidates& found, std::span<const Point2> scan_L, const MapView& map, double tolerance_m,
              const AcceptanceConfig& config) noexcept {
  Verdict verdict;
  if (found.list.empty()) {
    verdict.reason = found.end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
    return verdict;
  }
  const double tests = std::log10(static_cast<double>(std::max<std::uint64_t>(found.poses_tried, 1)));
  const Candidate& best = found.list[0];
  verdict.log10_false_alarms = tests + best.log10_chance;
  verdict.status = FixStatus::Fix;
  verdict.reason = FixReason::None;
  if (config.rule == AcceptanceRule::Paper) {
    return verdict;
  }
  const double risk = std::log10(config.false_alarm_risk);
  if (verdict.log10_false_alarms > risk) {
    verdict.status = FixStatus::NoFix;
    verdict.reason = found.end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
    return verdict;
  }
  if (!precise(best, scan_L, map.positions_W, tolerance_m, config)) {
    verdict.status = FixStatus::NoFix;
    verdict.reason = FixReason::TooFewLandmarks;
    return verdict;
  }
  for (const Candidate& rival : found.list) {
    if (!elsewhere(best.pose_W, rival.pose_W, config)) {
      continue;
    }
    const double rival_false_alarms = tests + rival.log10_chance;
    const bool close = verdict.log10_false_alarms - std::min(0.0, rival_false_alarms) > risk;
    if (close || (rival_false_alarms <= risk && !beats(best, rival, scan_L, map.positions_W, config))) {
      verdict.status = FixStatus::Ambiguous;
      verdict.reason = FixReason::Symmetric;
      return verdict;
    }
  }
  return verdict;
}

}  // namespace slamsensor::core
