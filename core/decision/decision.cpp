#include "core/decision/decision.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace slamsensor::core {
namespace {

constexpr double kCopyDecades = 3.0;  // stage 2
constexpr double kTieDecades = 3.0;
constexpr double kUsualContradiction = 1.0;  // the decades that a right pose shows by chance
constexpr double kRivalDecades = 2.0;        // stage 3: what makes a place a rival ...
constexpr double kRivalShare =
    0.5;  // ... unless the answer explains the witnesses by this much more decades ...
constexpr double kRivalMargin = 1.0;  // ... and how much more has to contradict it
constexpr double kLesserMap = 10.0;   // decades by which a place in another map explains less and is no rival
constexpr double kSigmas = 3.3;       // of a pose, which stay within what is called right
constexpr double kLocalSigmas = 1.0;
constexpr double kLocalRisk = 1e-4;          // of a scan in a local map
constexpr double kTieRiskShare = 1e-3;       // of the risk of a fix: a tie binds many scans
constexpr double kLocalContradiction = 4.0;  // decades against a scan in a local map
constexpr double kAgainDecades = 1.0;        // two groups, and no more against them than usual
constexpr double kUnlikeDecades = 2.0;       // three groups
constexpr double kUnlikeContradiction = 5.0;
constexpr double kUnlikeStructure = 7.0;  // of a world that hardly repeats itself
constexpr double kUnlikeMargin = 6.0;     // decades above what wrong places of this world reach
constexpr double kUnlikeTieMargin = 9.0;
constexpr double kUnlikeFarMargin = 15.0;  // from which on three groups are enough for a tie, too
constexpr double kBeyondWrong =
    1.0;  // decades above what wrong places of a world that repeats itself reach ...
constexpr double kBeyondShare = 0.25;      // ... and at least this share of them
constexpr double kTieContradiction = 2.0;  // and against a tie
// Prior odds of a place that no map has: even, but in a survey, whose giver says that the sensor is in it.
constexpr double kUnmapped = 1.0;
constexpr double kUnmappedSurvey = 1.0 / 300.0;

double decades_of(double nats) noexcept {
  return nats / std::numbers::ln10;
}

bool is_precise(const Evidence& evidence, Stake stake, const AcceptanceConfig& config) noexcept {
  const double sigmas = stake == Stake::Local ? kLocalSigmas : kSigmas;
  return sigmas * position_sigma_m(evidence.covariance) <= config.elsewhere_m &&
         sigmas * std::sqrt(evidence.covariance(2, 2)) <= config.elsewhere_rad;
}

double risk_of(Stake stake, const AcceptanceConfig& config) noexcept {
  switch (stake) {
    case Stake::Local:
      return std::max(kLocalRisk, config.risk);
    case Stake::Tie:
    case Stake::Follow:
      return kTieRiskShare * config.risk;
    case Stake::Fix:
    case Stake::Again:
    case Stake::Survey:
      break;
  }
  return config.risk;
}

double copies_wanted(Stake stake) noexcept {
  return stake == Stake::Tie                               ? kTieDecades
         : stake == Stake::Again || stake == Stake::Follow ? kAgainDecades
                                                           : kCopyDecades;
}

/// Whether `other` is another place than the answer.
bool rivals(const Weighed& other, const Weighed& answer, Stake stake, double structure_decades,
            const AcceptanceConfig& config) noexcept {
  if (other.candidate.map != answer.candidate.map) {
    // In a world that may repeat itself, a place in another map is a rival of a fix, and one that explains
    // more is a rival of a tie. It is none of a fix when that map explains the scan by kLesserMap decades
    // less; nor when an earlier scan said that both places are one, as long as nothing has been seen twice.
    const double lesser = stake == Stake::Fix ? kLesserMap : 0.0;
    const bool counts = stake != Stake::Survey && stake != Stake::Local &&
                        decades_of(other.evidence.ln_bayes - answer.evidence.ln_bayes) > -lesser;
    const bool is_shown = other.is_same_place && structure_decades <= Rates::kStartStructure;
    return counts && !is_shown && structure_decades >= kUnlikeStructure &&
           other.candidate.matches.size() >= 3;
  }
  return elsewhere(other.candidate.pose_W, answer.candidate.pose_W, config);
}

/// Whether nothing contradicts the answer in a world that hardly repeats itself, and it explains the
/// witnesses far better than wrong places of this world ever did.
bool stands_alone(const Evidence& evidence, Stake stake, double structure_decades) noexcept {
  const bool is_tie = stake == Stake::Tie || stake == Stake::Follow;
  const double margin = decades_of(evidence.ln_bayes) - structure_decades;
  const double groups = is_tie ? evidence.group_decades : evidence.small_group_decades;
  return groups >= (is_tie && margin < kUnlikeFarMargin ? kTieDecades : kUnlikeDecades) &&
         evidence.contradiction_decades() <= kUnlikeContradiction && structure_decades <= kUnlikeStructure &&
         margin >= (is_tie ? kUnlikeTieMargin : kUnlikeMargin);
}

/// Whether wrong places of a world that repeats itself explain about as much.
bool is_as_wrong_places(double decades, double structure_decades) noexcept {
  return structure_decades > Rates::kStartStructure &&
         decades < structure_decades + std::max(kBeyondWrong, kBeyondShare * structure_decades);
}

Verdict refuse(Verdict verdict, FixStatus status, FixReason reason) noexcept {
  verdict.status = status;
  verdict.reason = reason;
  return verdict;
}

}  // namespace

double position_sigma_m(const Eigen::Matrix3d& covariance) noexcept {
  const double half_trace = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double half_gap = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(std::max(0.0, half_trace + std::hypot(half_gap, covariance(0, 1))));
}

bool elsewhere(const Pose2& a, const Pose2& b, const AcceptanceConfig& config) noexcept {
  return (a.translation() - b.translation()).norm() > config.elsewhere_m ||
         std::abs(wrap_angle(a.heading_rad - b.heading_rad)) > config.elsewhere_rad;
}

std::size_t best_in(std::span<const Weighed> weighed, MapSlot map) noexcept {
  std::size_t best = SIZE_MAX;
  for (std::size_t i = 0; i < weighed.size(); ++i) {
    if (weighed[i].candidate.map == map && weighed[i].candidate.matches.size() >= 3 &&
        (best == SIZE_MAX || weighed[i].evidence.ln_bayes > weighed[best].evidence.ln_bayes)) {
      best = i;
    }
  }
  return best;
}

double runner_up_decades(std::span<const Weighed> weighed, std::size_t chosen,
                         const AcceptanceConfig& config) noexcept {
  double nats = 0.0;
  for (const Weighed& other : weighed) {
    if (other.candidate.map == weighed[chosen].candidate.map &&
        elsewhere(other.candidate.pose_W, weighed[chosen].candidate.pose_W, config)) {
      nats = std::max(nats, other.evidence.ln_bayes);
    }
  }
  return decades_of(nats);
}

Verdict decide(std::span<const Weighed> weighed, MapSlot map, Stake stake, SearchEnd end,
               double structure_decades, const AcceptanceConfig& config) noexcept {
  Verdict verdict;
  verdict.chosen = best_in(weighed, map);
  const FixReason silence = end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
  if (verdict.chosen == SIZE_MAX) {
    return refuse(verdict, FixStatus::NoFix, silence);
  }
  const Weighed& best = weighed[verdict.chosen];
  const auto is_rival = [&](const Weighed& other) {
    return &other != &best && rivals(other, best, stake, structure_decades, config);
  };
  const double unmapped = stake == Stake::Survey ? kUnmappedSurvey : kUnmapped;
  const double others =
      std::accumulate(weighed.begin(), weighed.end(), unmapped, [&](double sum, const Weighed& other) {
        return sum + (is_rival(other) ? std::exp(std::min(other.evidence.ln_bayes, 600.0)) : 0.0);
      });
  const double decades = decades_of(best.evidence.ln_bayes);
  const double chance = std::log10(unmapped) - decades;
  const double risk = std::log10(risk_of(stake, config));
  const double odds = std::log10(others) - decades;
  const double contradictions = best.evidence.contradiction_decades();
  const bool goes_on = stake == Stake::Again || stake == Stake::Follow;
  const double groups = goes_on ? best.evidence.small_group_decades : best.evidence.group_decades;
  const double copies = groups - std::max(0.0, contradictions - kUsualContradiction);
  const bool is_tie = stake == Stake::Tie || stake == Stake::Follow;
  verdict.log10_expected_wrong = std::min(0.0, odds);
  if (chance > risk) {
    return refuse(verdict, FixStatus::NoFix, silence);
  }
  if (!is_precise(best.evidence, stake, config)) {
    return refuse(verdict, FixStatus::NoFix, FixReason::TooFewLandmarks);
  }
  const bool asks_for_copies = stake == Stake::Fix || stake == Stake::Again || is_tie;
  const bool asks_for_rivals =
      asks_for_copies || (stake == Stake::Local && structure_decades >= kUnlikeStructure);
  const bool is_unlike_others = stands_alone(best.evidence, stake, structure_decades);
  if ((!asks_for_copies && contradictions > kLocalContradiction) ||
      (is_tie && contradictions > kTieContradiction)) {
    return refuse(verdict, FixStatus::NoFix, FixReason::NoOverlap);
  }
  if (odds > risk || (stake == Stake::Fix && is_as_wrong_places(decades, structure_decades))) {
    return refuse(verdict, FixStatus::Ambiguous, FixReason::Symmetric);
  }
  if (asks_for_rivals && end == SearchEnd::Deadline && structure_decades >= kUnlikeStructure) {
    return refuse(verdict, FixStatus::Ambiguous, FixReason::Deadline);  // a rival may not have been found yet
  }
  const double rival_decades = std::max(kRivalDecades, kRivalShare * decades);
  for (const Weighed& other : weighed) {
    if (asks_for_rivals && is_rival(other) && decades_of(other.evidence.ln_bayes) >= rival_decades &&
        other.evidence.contradiction_decades() < contradictions + kRivalMargin) {
      return refuse(verdict, FixStatus::Ambiguous, FixReason::Symmetric);
    }
  }
  if (asks_for_copies && !is_unlike_others && copies < copies_wanted(stake)) {
    return refuse(verdict, FixStatus::Ambiguous, FixReason::Copy);
  }
  verdict.status = FixStatus::Fix;
  verdict.reason = FixReason::None;
  return verdict;
}

}  // namespace slamsensor::core
