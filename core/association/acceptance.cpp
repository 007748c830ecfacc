#include "core/association/acceptance.hpp"

#include <algorithm>
#include <cmath>

#include "core/association/false_alarms.hpp"

namespace slamsensor::core {
namespace {

// The neighbourhood over which the map's density is taken, in tolerances: wide enough to hold several landmarks, narrow
// enough to tell a thicket from a clearing.
constexpr double kDensityRadiusTolerances = 15.0;

struct Disagreement {
  std::uint32_t only_best = 0;
  std::uint32_t only_rival = 0;
};

/// Counts the scan landmarks that just one of the two explains.
Disagreement disagreement(const MatchList& best, const MatchList& rival) noexcept {
  Disagreement d;
  std::size_t b = 0;
  std::size_t r = 0;
  while (b < best.size() || r < rival.size()) {
    if (r == rival.size() || (b < best.size() && best[b].scan < rival[r].scan)) {
      ++d.only_best;
      ++b;
    } else if (b == best.size() || rival[r].scan < best[b].scan) {
      ++d.only_rival;
      ++r;
    } else {
      ++b;
      ++r;
    }
  }
  return d;
}

double log10_false_alarms(const Candidate& candidate, std::uint64_t poses_tried, std::span<const Point2> scan_L,
                          const MapView& map, double tolerance_m) noexcept {
  return log10_expected_false_alarms(poses_tried, static_cast<std::uint32_t>(scan_L.size()),
                                     static_cast<std::uint32_t>(candidate.matches.size()),
                                     chance_match(candidate.pose_W, scan_L, map, tolerance_m));
}

}  // namespace

double chance_match(const Pose2& pose_W, std::span<const Point2> scan_L, const MapView& map,
                    double tolerance_m) noexcept {
  if (scan_L.empty()) {
    return 0.0;
  }
  const double radius_m = kDensityRadiusTolerances * tolerance_m;
  const double share = (tolerance_m * tolerance_m) / (radius_m * radius_m);
  double sum = 0.0;
  for (const Point2& p : scan_L) {
    sum += std::min(1.0, share * map.grid.count_within(pose_W * p, radius_m));
  }
  return sum / static_cast<double>(scan_L.size());
}

Verdict judge(const Candidates& found, std::span<const Point2> scan_L, const MapView& map, double tolerance_m,
              const AcceptanceConfig& config) noexcept {
  Verdict verdict;
  if (found.list.empty()) {
    verdict.reason = found.end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
    return verdict;
  }
  const Candidate& best = found.list[0];
  verdict.log10_false_alarms = log10_false_alarms(best, found.poses_tried, scan_L, map, tolerance_m);
  if (config.rule == AcceptanceRule::Paper) {
    verdict.status = FixStatus::Fix;
    verdict.reason = FixReason::None;
    return verdict;
  }
  const double risk = std::log10(config.false_alarm_risk);
  if (verdict.log10_false_alarms > risk) {
    verdict.reason = found.end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
    return verdict;
  }
  verdict.status = FixStatus::Fix;
  verdict.reason = FixReason::None;
  const double margin = std::log10(config.ambiguity_risk);
  const ScanMoments moments(scan_L);
  for (const Candidate& rival : found.list) {
    if (moments.displacement_m(best.pose_W, rival.pose_W) <= 2.0 * tolerance_m) {
      continue;  // the same place
    }
    const double rival_false_alarms = log10_false_alarms(rival, found.poses_tried, scan_L, map, tolerance_m);
    const Disagreement d = disagreement(best.matches, rival.matches);
    const bool close = rival_false_alarms + margin < verdict.log10_false_alarms;
    const bool structured = rival_false_alarms <= risk && log10_rival_chance(d.only_best, d.only_rival) > margin;
    if (close || structured) {
      verdict.status = FixStatus::Ambiguous;
      verdict.reason = FixReason::Symmetric;
      return verdict;
    }
  }
  return verdict;
}

}  // namespace slamsensor::core
