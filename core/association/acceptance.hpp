#pragma once

#include "core/association/candidate.hpp"
#include "core/association/map_view.hpp"
#include "core/config.hpp"
#include "core/fix.hpp"

#include <cstddef>
#include <span>

namespace slamsensor::core {

/// What is to be thought of the best candidate of a search.
struct Verdict {
  FixStatus status = FixStatus::NoFix;
  FixReason reason = FixReason::NoOverlap;
  double log10_false_alarms = 0.0;  ///< of the best candidate; 0 when there is none
};

/// Covariance of a candidate's pose, (x m, y m, heading rad) in W, from its residuals (pose_covariance).
[[nodiscard]] Eigen::Matrix3d candidate_covariance(const Candidate& candidate, std::span<const Point2> scan_L,
                                                   std::span<const Point2> map_W,
                                                   double tolerance_m) noexcept;

/// Whether believing `a` where `b` is true would be wrong: farther or turned by more than `config` allows.
[[nodiscard]] bool elsewhere(const Pose2& a, const Pose2& b, const AcceptanceConfig& config) noexcept;

/// Judges `found.list[0]` by the configured rule. Computed: a fix when its expected false alarms stay below
/// the risk, and stay there after the background is corrected by every rival elsewhere: where poses as good
/// as the rival are found although hardly one was to be expected, chance is better at this place than the
/// model says, by that much. A rival that is itself below the risk must moreover lose a sign test: the best
/// explains more landmarks of the scan better than the rival does, by more than two equally good poses would
/// show. And three sigma of the pose must stay within what is called right, else there are too few landmarks,
/// or they stand badly. Paper: a fix whenever there is a candidate.
[[nodiscard]] Verdict judge(const Candidates& found, std::span<const Point2> scan_L, const MapView& map,
                            double tolerance_m, const AcceptanceConfig& config) noexcept;

}  // namespace slamsensor::core
