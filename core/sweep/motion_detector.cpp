#include "core/sweep/motion_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::core {
namespace {

constexpr double kAgreeingMin = 0.4;      // of an estimate
constexpr std::uint32_t kRisenMin = 2;    // new things before old background ...
constexpr double kRisenShare = 0.3;       // ... and this many for each that stood
constexpr double kBreakShare = 0.4;       // of what was known of the line before
constexpr double kRisenAtBreak = 0.15;    // of what such a line sees
constexpr double kRisenNowShare = 0.25;   // of what an incoherent line sees
constexpr std::uint32_t kLinesInRow = 3;  // without an agreement

/// Whether two lines tell of the same motion.
bool agree(const MotionEstimate& a, const MotionEstimate& b, const MotionConfig& config) noexcept {
  const bool same_way = a.x_m * b.x_m + a.y_m * b.y_m > 0.5 * a.distance_m * b.distance_m &&
                        std::min(a.distance_m, b.distance_m) > config.distance_min_m;
  const bool same_turn = a.turn_rad * b.turn_rad > 0.0 &&
                         std::min(std::abs(a.turn_rad), std::abs(b.turn_rad)) > config.angle_min_rad;
  return same_way || same_turn;
}

}  // namespace

void MotionDetector::begin_scan() noexcept {
  tracks_.clear();
  report_ = {};
  suspects_ = {};
  incoherent_ = suspect_ = 0;
  known_share_ = 0.0;
  is_broken_ = has_moved_ = false;
}

void MotionDetector::add(const Scanline& line) noexcept {
  if (!config_.enabled || has_moved_) {
    return;
  }
  marks_.build(line, config_.range_max_m);
  const std::uint64_t dropped = tracks_.dropped();
  tracks_.add(marks_);
  counters_.count(MotionEvent::MarksDropped, tracks_.dropped() - dropped);
  report_.tally = tracks_.tally();
  report_.jump = fitter_.fit(tracks_.shifts(), MotionKind::Jump, config_.things_min);
  report_.creep = fitter_.fit(tracks_.shifts(), MotionKind::Creep, config_.things_min);
  counters_.count(report_.jump ? MotionEvent::LinesJudged : MotionEvent::LinesNotJudged);
  if (is_displaced()) {
    give_up(MotionEvent::ScansDisplaced);
  } else if (is_changed()) {
    give_up(MotionEvent::ScansChanged);
  } else if (is_incoherent()) {
    give_up(MotionEvent::ScansIncoherent);
  }
}

bool MotionDetector::is_suspect(const std::optional<MotionEstimate>& estimate) const noexcept {
  if (!estimate || estimate->agreeing < kAgreeingMin) {
    return false;
  }
  const bool is_far = estimate->distance_m > config_.distance_min_m &&
                      estimate->distance_m > config_.sigmas * estimate->distance_sigma_m;
  const double turn_rad = std::abs(estimate->turn_rad);
  return is_far || (turn_rad > config_.angle_min_rad && turn_rad > config_.sigmas * estimate->turn_sigma_rad);
}

bool MotionDetector::is_displaced() noexcept {
  bool agreed = false;
  bool suspect = false;
  const std::array<std::optional<MotionEstimate>, 2> estimates = {report_.jump, report_.creep};
  for (std::size_t kind = 0; kind < estimates.size(); ++kind) {
    const bool is_one = is_suspect(estimates[kind]);
    agreed = agreed || (is_one && suspects_[kind] && agree(*estimates[kind], *suspects_[kind], config_));
    suspects_[kind] = is_one ? estimates[kind] : std::nullopt;
    suspect = suspect || is_one;
  }
  counters_.count(MotionEvent::LinesSuspect, suspect ? 1 : 0);
  suspect_ = suspect ? suspect_ + 1 : 0;
  return agreed || suspect_ >= kLinesInRow;
}

/// What stood is gone, and other things stand before what was seen behind it; or all of a sudden next to
/// nothing of a line was known, and what had stood has not come back in the next one either.
bool MotionDetector::is_changed() noexcept {
  const MarkTally& tally = report_.tally;
  const bool is_gone =
      tally.standing >= config_.things_min && tally.lost >= config_.lost_share_min * tally.standing;
  const bool has_risen = tally.risen >= std::max<double>(kRisenMin, kRisenShare * tally.standing);
  const bool was_broken = std::exchange(is_broken_, breaks_off());
  return is_gone && (has_risen || was_broken);
}

/// Whether fewer marks are known in this line than in the one before by more than chance does.
bool MotionDetector::breaks_off() noexcept {
  const auto seen = static_cast<double>(report_.tally.seen);
  const double known_share = seen > 0.0 ? report_.tally.known / seen : 0.0;
  const double before = std::exchange(known_share_, known_share);
  const double sigma = std::sqrt(before * (1.0 - before) / std::max(1.0, seen)) + 0.5 / std::max(1.0, seen);
  return report_.tally.risen_now > kRisenAtBreak * seen && known_share < kBreakShare * before &&
         before - known_share > config_.sigmas * sigma;
}

/// Whether line after line sees new things before what was seen until then, and nothing stands.
bool MotionDetector::is_incoherent() noexcept {
  const MarkTally& tally = report_.tally;
  const bool something_stands =
      tally.standing >= config_.things_min && tally.lost < config_.lost_share_min * tally.standing;
  const bool is_one = !something_stands && tally.seen >= 2 * config_.things_min &&
                      tally.known < config_.coherent_share_min * tally.seen &&
                      tally.risen_now > kRisenNowShare * tally.seen;
  incoherent_ = is_one ? incoherent_ + 1 : 0;
  return incoherent_ >= kLinesInRow;
}

void MotionDetector::give_up(MotionEvent why) noexcept {
  has_moved_ = true;
  counters_.count(why);
}

}  // namespace slamsensor::core
