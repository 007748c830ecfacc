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

constexpr double kSpeedError = 0.01;  // of the unit's, and of its clock
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
}

PtuJudgement PtuTrack::judge(const PtuSighting& sighting) noexcept {
  switch (state_) {
    case State::Resting:
      return sighting.position == position_ ? believe(sighting) : doubt(PtuVerdict::Implausible);
    case State::Following:
      return judge_way(sighting);
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

}  // namespace slamsensor::hal
