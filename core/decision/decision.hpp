#pragma once

#include "core/decision/evidence.hpp"
#include "core/fix.hpp"

#include <span>

namespace slamsensor::core {

/// A candidate and what speaks for and against it.
struct Weighed {
  Candidate candidate;
  Evidence evidence;
  bool is_same_place = false;  ///< its map may lie so that this place and the answer's are one
};

/// What is to be thought of the candidates of a search in one map.
struct Verdict {
  FixStatus status = FixStatus::NoFix;
  FixReason reason = FixReason::NoOverlap;
  std::size_t chosen = SIZE_MAX;      ///< the best candidate in that map; none when there is none
  double log10_expected_wrong = 0.0;  ///< expected wrong fixes if all such answers were believed, at most 0
};

/// How much a decision binds.
enum class Stake : std::uint8_t {
  Fix,     ///< a fix in the home map
  Again,   ///< the same of a scan that shows again what the scan before it showed, which was believed in this
           ///< map
  Survey,  ///< a fix in a complete survey: copies are all known, and where nothing stands nothing is
  Local,   ///< one more scan of a local map: it binds nothing until the map is tied
  Tie,     ///< two maps become one: many scans are bound at once
  Follow,  ///< a tie of a map that began with the scan after the last one in the other: that scan showed
           ///< again what was just seen
};

/// The decision (DESIGN 2.4), in three stages, each of which must be passed by the leading candidate of
/// `map`:
///
/// 1. Chance. The posterior odds against all other places and an unmapped one, BF / (u + sum of the others),
///    exceed 1 / risk. u = 1, and 1/300 in a survey: whoever gives one says that the sensor is in it. (Of
///    60,000 scans of other forests the strongest reached BF = 10^3.5.)
/// 2. A copy that was never mapped. Independent groups of matches less the decades of contradiction reach
///    three decades; one decade of a scan that shows again what the scan before showed, and of a map that
///    began where the other was left: to be wrong, the carrier must have been taken to a perfect copy between
///    the two. Where the world does not repeat itself (`structure_decades`, Rates) three groups, each as wide
///    as a copse, are enough when nothing contradicts them and the answer explains the witnesses by far more
///    than wrong places ever did; a tie asks for more of it, or a fourth. A sensor of short reach never sees
///    beyond a copy of the usual size: in a known world without copies, what goes on where it was just seen,
///    and a scan whose three groups are enough, count groups of three quarters of its reach. A tie has at
///    most two decades against it, however much speaks for it. Not asked of a local map, nor in a complete
///    survey.
/// 3. A copy that was mapped. Every other place that explains the witnesses hundredfold better than chance is
///    contradicted by a decade more than the answer is; raw odds mislead here, because what is missing at one
///    place may be new ground at the other. A place in another map counts where the world may repeat itself,
///    unless that map explains ten decades less, or is known to lie so that both places are one. And where
///    the world repeats itself, the answer explains more than wrong places of this map do, by a decade and by
///    a quarter.
///
/// And three sigma of the pose beside its landmarks stay within what is called right.
[[nodiscard]] Verdict decide(std::span<const Weighed> weighed, MapSlot map, Stake stake, SearchEnd end,
                             double structure_decades, const AcceptanceConfig& config) noexcept;

/// Decades by which the best place elsewhere in the map of `chosen` explains the witnesses; 0 when there is
/// none.
[[nodiscard]] double runner_up_decades(std::span<const Weighed> weighed, std::size_t chosen,
                                       const AcceptanceConfig& config) noexcept;

/// The place in `map` that explains the witnesses best; SIZE_MAX when there is none.
[[nodiscard]] std::size_t best_in(std::span<const Weighed> weighed, MapSlot map) noexcept;

/// Whether believing `a` where `b` is true would be wrong: farther or turned by more than `config` allows.
[[nodiscard]] bool elsewhere(const Pose2& a, const Pose2& b, const AcceptanceConfig& config) noexcept;

/// Length (m) of the longer axis of the one-sigma ellipse of the position.
[[nodiscard]] double position_sigma_m(const Eigen::Matrix3d& covariance) noexcept;

}  // namespace slamsensor::core
