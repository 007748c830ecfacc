#pragma once

#include <cstddef>
#include <span>

#include "core/association/candidate.hpp"
#include "core/association/map_view.hpp"
#include "core/config.hpp"
#include "core/fix.hpp"

namespace slamsensor::core {

/// What is to be thought of the best candidate of a search.
struct Verdict {
  FixStatus status = FixStatus::NoFix;
  FixReason reason = FixReason::NoOverlap;
  double log10_false_alarms = 0.0;  ///< of the best candidate; 0 when there is none
};

/// Mean chance that a landmark of the scan falls within `tolerance_m` of some landmark of the map by accident, from the
/// map's density in the neighbourhood of where `pose_W` puts each of them. In [0, 1].
[[nodiscard]] double chance_match(const Pose2& pose_W, std::span<const Point2> scan_L, const MapView& map,
                                  double tolerance_m) noexcept;

/// Judges `found.list[0]` by the configured rule. Computed: a fix when its expected false alarms stay below the risk and
/// no rival elsewhere (farther than two tolerances, root mean square over the scan) comes close: a rival that is itself
/// below the risk must lose a sign test over the landmarks that only one of the two explains, and any rival must be
/// 1 / ambiguity_risk times more expected by chance. Paper: a fix whenever there is a candidate.
[[nodiscard]] Verdict judge(const Candidates& found, std::span<const Point2> scan_L, const MapView& map,
                            double tolerance_m, const AcceptanceConfig& config) noexcept;

}  // namespace slamsensor::core
