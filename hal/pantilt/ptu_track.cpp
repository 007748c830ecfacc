#include "hal/pantilt/ptu_track.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamsensor::hal {
namespace {

constexpr int kArrivedPolls = 2;  // at the target
constexpr int kStillPolls = 3;    // at the same place, wherever
constexpr int kStuckPolls = 3;
constexpr int kLostPolls = 5;
constexpr int kAgreedToBegin = 2;   // sightings that settle the lag of a move
constexpr int kAgreedToChange = 3;  // against the lag believed so far

constexpr int kOnWay = 3;            // on the way, but not as the profile says
constexpr double kStillPlaces = 10;  // an axis stands that is slower than one place in the time of so many

constexpr double kSpeedError = 0.01;  // of the unit's, and of its clock
constexpr double kSpeedBound = 1.05;  // share of its speed that an axis may be seen to go
constexpr double kStillLeast_s = 0.25;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

void PtuTrack::set_up(double position_rad, double speed_max_radps, Stamp slack) noexcept {
  position_rad_ = position_rad;
  speed_max_radps_ = speed_max_radps;
  slack_s_ = to_seconds(slack);
}

void PtuTrack::rest(std::int32_t position) noexcept {
  roam();
  state_ = State::Resting;
  position_ = position;
}

void PtuTrack::follow(const Way& way) noexcept {
  roam();
  state_ = State::Following;
  way_ = way;
}

void PtuTrack::roam() noexcept {
  state_ = State::Roaming;
  anchor_.reset();
  candidate_.reset();
  last_.reset();
  agreed_ = 0;
  same_ = 0;
  doubted_ = 0;
  way_seen_.reset();
  held_.reset();
  on_way_ = 0;
}

PtuJudgement PtuTrack::judge(const PtuSighting& sighting) noexcept {
  switch (state_) {
    case State::Resting:
      return sighting.position == position_ ? believe(sighting) : doubt(PtuVerdict::Implausible);
    case State::Following:
      return judge_way(sighting);
    case State::Bounded:
      return judge_bounded(sighting);
    case State::Roaming:
      return judge_roaming(sighting);
  }
  return {};
}

PtuJudgement PtuTrack::doubt(PtuVerdict verdict) noexcept {
  ++doubted_;
  same_ = 0;
  return {doubted_ >= kLostPolls ? PtuVerdict::Lost : verdict, std::nullopt};
}

PtuJudgement PtuTrack::believe(const PtuSighting& sighting) noexcept {
  doubted_ = 0;
  position_ = sighting.position;
  last_ = sighting;
  return {PtuVerdict::Believed, std::nullopt};
}

PtuJudgement PtuTrack::judge_way(const PtuSighting& sighting) noexcept {
  const bool is_next = is_on_way(sighting, way_seen_);
  on_way_from_ = is_next && on_way_ > 0 ? on_way_from_ : sighting.position;
  on_way_ = is_next ? on_way_ + 1 : 0;
  way_seen_ = sighting;
  const PtuJudgement judgement = judge_profile(sighting);
  const bool is_lost = judgement.verdict == PtuVerdict::Lost;
  if (!is_lost || on_way_ < kOnWay || sighting.position == on_way_from_) {
    return judgement;
  }
  state_ = State::Bounded;
  held_ = sighting;
  still_since_ = sighting.stamp;
  same_ = 0;
  doubted_ = 0;
  return {PtuVerdict::Held, std::nullopt};
}

/// A position is believed when the next one can follow it.
PtuJudgement PtuTrack::judge_bounded(const PtuSighting& sighting) noexcept {
  if (!is_on_way(sighting, held_)) {
    if (is_on_way(sighting, way_seen_)) {
      held_ = sighting;
      still_since_ = sighting.stamp;
    }
    return doubt(PtuVerdict::Implausible);
  }
  const bool is_still = sighting.position == held_->position;
  still_since_ = is_still ? still_since_ : sighting.stamp;
  same_ = is_still ? same_ + 1 : 1;
  const PtuSighting earlier = *held_;
  way_seen_ = earlier;
  held_ = sighting;
  static_cast<void>(believe(earlier));
  if (sighting.position == way_.target && same_ >= kArrivedPolls) {
    rest(sighting.position);
    return {PtuVerdict::Believed, earlier};
  }
  const double still_s = kStillLeast_s + kStillPlaces * std::abs(position_rad_) / way_speed_radps();
  const bool stands = same_ >= kStillPolls && to_seconds(sighting.stamp - still_since_) > still_s;
  return {stands ? PtuVerdict::Lost : PtuVerdict::Held, earlier};
}

double PtuTrack::way_speed_radps() const noexcept {
  return way_.speed_radps > 0.0 ? way_.speed_radps : speed_max_radps_;
}

/// Whether the axis can be there, whatever its ramp, after it was at `before`, or else at its start.
bool PtuTrack::is_on_way(const PtuSighting& sighting,
                         const std::optional<PtuSighting>& before) const noexcept {
  const std::int32_t ahead = way_.target < way_.start ? -1 : 1;
  const std::int32_t way = (sighting.position - (before ? before->position : way_.start)) * ahead;
  if (way < 0 || (way_.target - sighting.position) * ahead < 0) {
    return false;
  }
  const Stamp since = before ? before->stamp - before->half_width : way_.begun - way_.early;
  const double apart_s = to_seconds(sighting.stamp + sighting.half_width - since) + slack_s_;
  return (way - 2) * std::abs(position_rad_) <= kSpeedBound * way_speed_radps() * apart_s;
}

PtuJudgement PtuTrack::judge_profile(const PtuSighting& sighting) noexcept {
  const std::optional<Lag> lag = lag_of(sighting);
  const Lag allowed{-to_seconds(way_.early), to_seconds(way_.late), true};
  if (!lag || !agree(*lag, allowed)) {
    const PtuJudgement judgement = doubt(PtuVerdict::Implausible);
    const bool unmoved = sighting.position == way_.start && !anchor_;
    return unmoved && doubted_ >= kStuckPolls ? PtuJudgement{PtuVerdict::Stuck, std::nullopt} : judgement;
  }
  const PtuJudgement judgement = judge_lag(sighting, *lag);
  if (judgement.verdict == PtuVerdict::Believed) {
    same_ = sighting.position == way_.target ? same_ + 1 : 0;
    if (same_ >= kArrivedPolls) {
      rest(sighting.position);
    }
  }
  return judgement;
}

PtuJudgement PtuTrack::judge_lag(const PtuSighting& sighting, const Lag& lag) noexcept {
  if (anchor_ ? agree(lag, *anchor_) : !lag.bounded) {
    if (anchor_ && lag.bounded) {
      narrow(lag, sighting.stamp);
    }
    candidate_.reset();
    return believe(sighting);
  }
  if (!lag.bounded) {
    return doubt(PtuVerdict::Implausible);
  }
  agreed_ = candidate_ && agree(lag, *candidate_) ? agreed_ + 1 : 1;
  if (agreed_ < (anchor_ ? kAgreedToChange : kAgreedToBegin)) {
    const bool first = !anchor_ && !candidate_;
    candidate_ = lag;
    last_ = sighting;
    return doubt(first ? PtuVerdict::Held : PtuVerdict::Implausible);
  }
  const std::optional<PtuSighting> held = anchor_ ? std::nullopt : last_;
  anchor_ = lag;
  anchored_ = sighting.stamp;
  candidate_.reset();
  PtuJudgement judgement = believe(sighting);
  judgement.earlier = held;
  return judgement;
}

PtuJudgement PtuTrack::judge_roaming(const PtuSighting& sighting) noexcept {
  if (last_) {
    const double way_rad = std::abs((sighting.position - last_->position) * position_rad_);
    const Stamp apart = sighting.stamp - last_->stamp + sighting.half_width + last_->half_width;
    if (way_rad > speed_max_radps_ * (to_seconds(apart) + slack_s_) + 2.0 * std::abs(position_rad_)) {
      return doubt(PtuVerdict::Implausible);
    }
  }
  same_ = last_ && last_->position == sighting.position ? same_ + 1 : 1;
  const PtuJudgement judgement = believe(sighting);
  if (same_ < kStillPolls) {
    return {PtuVerdict::Unproven, std::nullopt};
  }
  rest(sighting.position);
  return judgement;
}

/// How long after its profile the axis must have been, to be where it was seen: a position is reported whole,
/// so one either side.
std::optional<PtuTrack::Lag> PtuTrack::lag_of(const PtuSighting& sighting) const noexcept {
  const std::int32_t ahead = way_.target < way_.start ? -1 : 1;
  const std::int32_t length = (way_.target - way_.start) * ahead;
  const std::int32_t done = (sighting.position - way_.start) * ahead;
  if (done < 0 || done > length) {
    return std::nullopt;
  }
  const double elapsed_s = to_seconds(sighting.stamp - way_.begun);
  const double half_s = to_seconds(sighting.half_width);
  Lag lag{-kInfinity, kInfinity, done > 1 && done < length - 1};
  if (done < length - 1) {
    lag.low_s = elapsed_s - half_s - way_.profile.elapsed_s((sighting.position + ahead) * position_rad_);
  }
  if (done > 1) {
    lag.high_s = elapsed_s + half_s - way_.profile.elapsed_s((sighting.position - ahead) * position_rad_);
  }
  return lag;
}

/// The lag is one and the same for all of a move but for a small error of speed, so every sighting narrows
/// what it can be.
void PtuTrack::narrow(const Lag& lag, Stamp seen) noexcept {
  const double drift_s = kSpeedError * to_seconds(seen - anchored_);
  const Lag both{std::max(lag.low_s, anchor_->low_s - drift_s),
                 std::min(lag.high_s, anchor_->high_s + drift_s), true};
  anchor_ = both.low_s <= both.high_s ? both : lag;
  anchored_ = seen;
}

bool PtuTrack::agree(const Lag& a, const Lag& b) const noexcept {
  return a.low_s <= b.high_s + slack_s_ && b.low_s <= a.high_s + slack_s_;
}

namespace {

constexpr std::size_t kSeenLeast = 8;
constexpr double kMisfitMost = 4.0;      // mean square in sigmas: what rounding and stamps leave is about 1
constexpr double kMisfitAccepted = 2.5;  // of a ramp that is to replace the one told
constexpr double kOutlier = 5.0;         // sigmas; more counts as so many
constexpr double kRampShortest_s = 0.01;
constexpr int kRampSteps = 24;     // from there on, each longer by ...
constexpr double kRampStep = 1.3;  // ... this factor: to 4 s
constexpr int kRefinements = 16;

}  // namespace

void PtuRampFit::begin(const PtuTrack::Way& way, double position_rad, Stamp slack) noexcept {
  way_ = way;
  position_rad_ = position_rad;
  slack_s_ = to_seconds(slack);
  seen_size_ = 0;
  stride_ = 1;
  skipped_ = 0;
  is_active_ = true;
}

void PtuRampFit::add(const PtuSighting& sighting) noexcept {
  const std::int32_t ahead = way_.target < way_.start ? -1 : 1;
  const bool is_between =
      (sighting.position - way_.start) * ahead > 1 && (way_.target - sighting.position) * ahead > 1;
  if (!is_active_ || !is_between || ++skipped_ < stride_) {
    return;
  }
  skipped_ = 0;
  if (seen_size_ == kSeenMax) {
    thin_out();
  }
  seen_[seen_size_++] = sighting;
}

void PtuRampFit::thin_out() noexcept {
  for (std::size_t i = 0; i < kSeenMax / 2; ++i) {
    seen_[i] = seen_[2 * i];
  }
  seen_size_ = kSeenMax / 2;
  stride_ *= 2;
}

std::optional<PtuRampFit::Result> PtuRampFit::end(const AxisDynamics& told) noexcept {
  const bool is_enough = is_active_ && seen_size_ >= kSeenLeast && way_.speed_radps > 0.0;
  is_active_ = false;
  if (!is_enough) {
    return std::nullopt;
  }
  if (misfit(told) <= kMisfitMost) {
    return Result{};
  }
  Result result{true, std::nullopt};
  double least = kMisfitAccepted;
  const auto consider = [&](const AxisDynamics& dynamics) {
    const double here = misfit(dynamics);
    if (here < least) {
      least = here;
      result.better = dynamics;
    }
  };
  consider({way_.speed_radps, told.acceleration_radps2});  // no ramp
  consider(best_ramp(told.base_speed_radps));
  for (const double share : {0.0, 0.06, 0.12, 0.25, 0.5, 0.75}) {
    consider(best_ramp(share * way_.speed_radps));
  }
  return result;
}

/// The best acceleration from `base_speed_radps` on.
AxisDynamics PtuRampFit::best_ramp(double base_speed_radps) const noexcept {
  const double gain_radps = std::max(way_.speed_radps - base_speed_radps, 1e-3 * way_.speed_radps);
  const auto dynamics = [&](double ramp_s) { return AxisDynamics{base_speed_radps, gain_radps / ramp_s}; };
  double best_s = kRampShortest_s;
  double least = kInfinity;
  double ramp_s = kRampShortest_s;
  for (int i = 0; i < kRampSteps; ++i, ramp_s *= kRampStep) {
    const double here = misfit(dynamics(ramp_s));
    if (here < least) {
      least = here;
      best_s = ramp_s;
    }
  }
  double low_s = best_s / kRampStep;
  double high_s = best_s * kRampStep;
  for (int i = 0; i < kRefinements; ++i) {
    const double first_s = low_s + (high_s - low_s) / 3.0;
    const double second_s = high_s - (high_s - low_s) / 3.0;
    if (misfit(dynamics(first_s)) < misfit(dynamics(second_s))) {
      high_s = second_s;
    } else {
      low_s = first_s;
    }
  }
  return dynamics(0.5 * (low_s + high_s));
}

/// How far, in mean square sigmas, what was seen is from a move with `dynamics` that began as late as a move
/// may and whose speed is off by as much as it may.
double PtuRampFit::misfit(const AxisDynamics& dynamics) const noexcept {
  const MotionProfile profile(way_.start * position_rad_, way_.target * position_rad_, way_.speed_radps,
                              dynamics);
  std::array<double, kSeenMax> elapsed_s{};
  std::array<double, kSeenMax> lag_s{};
  std::array<double, kSeenMax> weight{};
  double sum_w = 0.0;
  double sum_x = 0.0;
  double sum_y = 0.0;
  for (std::size_t i = 0; i < seen_size_; ++i) {
    elapsed_s[i] = profile.elapsed_s(seen_[i].position * position_rad_);
    lag_s[i] = to_seconds(seen_[i].stamp - way_.begun) - elapsed_s[i];
    const double speed_radps = std::abs(profile.speed_radps(elapsed_s[i]));
    const double rounding_s = std::abs(position_rad_) / std::max(speed_radps, 1e-3 * way_.speed_radps);
    const double half_s = to_seconds(seen_[i].half_width);
    weight[i] = 3.0 / (half_s * half_s + slack_s_ * slack_s_ + rounding_s * rounding_s);
    sum_w += weight[i];
    sum_x += weight[i] * elapsed_s[i];
    sum_y += weight[i] * lag_s[i];
  }
  double sum_xx = 0.0;
  double sum_xy = 0.0;
  for (std::size_t i = 0; i < seen_size_; ++i) {
    const double x = elapsed_s[i] - sum_x / sum_w;
    sum_xx += weight[i] * x * x;
    sum_xy += weight[i] * x * (lag_s[i] - sum_y / sum_w);
  }
  const double slope = std::clamp(sum_xx > 0.0 ? sum_xy / sum_xx : 0.0, -kSpeedError, kSpeedError);
  const double begun_s =
      std::clamp((sum_y - slope * sum_x) / sum_w, -to_seconds(way_.early), to_seconds(way_.late));
  double sum = 0.0;
  for (std::size_t i = 0; i < seen_size_; ++i) {
    const double off_s = lag_s[i] - begun_s - slope * elapsed_s[i];
    sum += std::min(kOutlier * kOutlier, weight[i] * off_s * off_s);
  }
  return sum / static_cast<double>(seen_size_);
}

}  // namespace slamsensor::hal
