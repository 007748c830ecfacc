#include "hal/pantilt/ptu_axis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::hal {
namespace {

constexpr std::array<PtuQuantity, 7> kAsked{
    PtuQuantity::Resolution, PtuQuantity::MinPosition, PtuQuantity::MaxPosition, PtuQuantity::SpeedMin,
    PtuQuantity::SpeedMax,   PtuQuantity::BaseSpeed,   PtuQuantity::Acceleration};

constexpr double kArcsecPerDegree = 3600.0;
constexpr double kResolutionMinDeg = 1e-6;
constexpr double kResolutionMaxDeg = 1.0;
constexpr double kWholeMax = 1e6;
constexpr double kAccelerationMax = 1e9;

bool is_whole(double value) noexcept {
  return std::abs(value) <= kWholeMax && std::floor(value) == value;
}

bool possible(const PtuAxisFacts& facts, double resolution_deg) noexcept {
  return resolution_deg >= kResolutionMinDeg && resolution_deg <= kResolutionMaxDeg &&
         facts.min_position <= 0 && facts.max_position >= 0 && facts.min_position < facts.max_position &&
         facts.speed_min_ps >= 0 && facts.speed_min_ps < facts.speed_max_ps && facts.base_speed_ps >= 0 &&
         facts.acceleration_ps2 >= 0.0 && facts.acceleration_ps2 <= kAccelerationMax;
}

}  // namespace

void PtuInquiry::restart() noexcept {
  asked_ = 0;
  before_.reset();
}

PtuCommand PtuInquiry::question() const noexcept {
  return PtuCommand::query(asked_ < kPerAxis ? Axis::Pan : Axis::Tilt, kAsked[asked_ % kPerAxis]);
}

void PtuInquiry::answer(double value) noexcept {
  if (done()) {
    return;
  }
  if (before_ != value) {
    before_ = value;
    return;
  }
  values_[asked_++] = value;
  before_.reset();
}

std::optional<PtuAxisFacts> PtuInquiry::facts(Axis axis) const noexcept {
  const double* const values = values_.data() + (axis == Axis::Pan ? 0 : kPerAxis);
  for (std::size_t i = 1; i + 1 < kPerAxis; ++i) {
    if (!is_whole(values[i])) {
      return std::nullopt;
    }
  }
  const double resolution_deg = values[0] / kArcsecPerDegree;
  PtuAxisFacts facts;
  facts.position_rad = resolution_deg * std::numbers::pi / 180.0;
  facts.min_position = static_cast<std::int32_t>(values[1]);
  facts.max_position = static_cast<std::int32_t>(values[2]);
  facts.speed_min_ps = static_cast<std::int32_t>(values[3]);
  facts.speed_max_ps = static_cast<std::int32_t>(values[4]);
  facts.base_speed_ps = static_cast<std::int32_t>(values[5]);
  facts.acceleration_ps2 = values[6];
  return done() && possible(facts, resolution_deg) ? std::optional(facts) : std::nullopt;
}

AxisInfo ptu_axis_info(const PtuAxisFacts& facts, PtuSense sense) noexcept {
  const double unit_rad = facts.position_rad;
  AxisInfo info;
  info.min_rad = (sense == PtuSense::Normal ? facts.min_position : -facts.max_position) * unit_rad;
  info.max_rad = (sense == PtuSense::Normal ? facts.max_position : -facts.min_position) * unit_rad;
  info.resolution_rad = unit_rad;
  info.speed_min_radps = facts.speed_min_ps * unit_rad;
  info.speed_max_radps = facts.speed_max_ps * unit_rad;
  info.dynamics = {facts.base_speed_ps * unit_rad, facts.acceleration_ps2 * unit_rad};
  return info;
}

namespace {

constexpr int kRampsOff = 2;                         // moves in a row, until another ramp is used
constexpr double kDitherShare = 0.4;                 // of the period of polls: 20 % either way
constexpr double kDitherStep = 0.61803398874989485;  // golden section: fills 0..1 as evenly as can be

/// The moment in the middle between the command's last byte and the reply's first: the best guess of when the
/// unit acted on it.
Stamp acted(const PtuAnswer& answer) noexcept {
  return answer.sent + (answer.begun - answer.sent) / 2;
}

}  // namespace

void PtuAxis::set_up(const PtuAxisFacts& facts, std::int32_t position, Stamp now) noexcept {
  const PtuSense sense = axis_ == Axis::Pan ? config_.pan_sense : config_.tilt_sense;
  facts_ = facts;
  info_ = ptu_axis_info(facts, sense);
  unit_rad_ = sense == PtuSense::Normal ? facts.position_rad : -facts.position_rad;
  if (facts != told_) {
    told_ = facts;
    learnt_.reset();
    ramp_ = PtuRamp::AsTold;
  }
  ramps_off_ = 0;
  if (learnt_) {
    use(*learnt_);
  }
  track_.set_up(unit_rad_, info_.speed_max_radps, config_.stamp_slack);
  track_.rest(position);
  forget();
  status_.position_rad = position * unit_rad_;
  due_ = now;
}

void PtuAxis::forget() noexcept {
  status_ = {};
  request_.reset();
  speed_set_ = 0;
}

MoveStatus PtuAxis::ask(double target_rad, double speed_radps) noexcept {
  const double target = std::round(target_rad / unit_rad_);
  const double speed_ps = std::round(speed_radps / facts_.position_rad);
  const bool target_fits = target >= facts_.min_position && target <= facts_.max_position;
  const bool speed_fits = speed_ps >= std::max(1, facts_.speed_min_ps) && speed_ps <= facts_.speed_max_ps;
  if (!target_fits || !speed_fits) {
    return MoveStatus::OutOfRange;
  }
  if (request_) {
    return MoveStatus::Busy;
  }
  request_ = Request{static_cast<std::int32_t>(target), static_cast<std::int32_t>(speed_ps), std::nullopt};
  return MoveStatus::Accepted;
}

std::optional<PtuCommand> PtuAxis::next_command() const noexcept {
  if (!request_) {
    return std::nullopt;
  }
  return speed_set_ == request_->speed_ps ? PtuCommand::target(axis_, request_->target)
                                          : PtuCommand::speed(axis_, request_->speed_ps);
}

void PtuAxis::on_moved(const PtuAnswer& answer, Stamp now) noexcept {
  if (!request_) {
    return;
  }
  if (answer.outcome == PtuOutcome::Refused) {
    counters_.count(PtuEvent::MovesRejected);
    request_.reset();
    return;
  }
  const bool of_speed = answer.command.quantity() == PtuQuantity::Speed;
  if (answer.outcome == PtuOutcome::Failed) {
    counters_.count(PtuEvent::MovesRepeated);
    if (!of_speed) {
      request_->first_sent = request_->first_sent.value_or(answer.sent);
    }
    return;
  }
  if (of_speed) {
    on_speed_set();
    return;
  }
  begin_move(*request_, answer);
  request_.reset();
  due_ = now;
}

void PtuAxis::on_speed_set() noexcept {
  speed_set_ = request_->speed_ps;
  if (!track_.resting()) {
    // From here on the move under way goes at the new speed.
    ramp_fit_.cancel();
    track_.roam();
  }
}

void PtuAxis::begin_move(const Request& request, const PtuAnswer& answer) noexcept {
  const bool from_rest = track_.resting();
  const bool without_ramps = std::max(request.speed_ps, move_speed_) <= facts_.base_speed_ps;
  PtuTrack::Way way;
  way.begun = acted(answer);
  way.start = from_rest ? track_.position() : position_at(way.begun);
  way.target = request.target;
  way.profile = MotionProfile(way.start * unit_rad_, way.target * unit_rad_,
                              request.speed_ps * facts_.position_rad, info_.dynamics);
  way.early =
      way.begun - request.first_sent.value_or(way.begun) + (from_rest ? Stamp{} : config_.move_latency_max);
  way.late = config_.move_latency_max;
  way.speed_radps = request.speed_ps * facts_.position_rad;
  ramp_fit_.cancel();
  if (from_rest) {
    ramp_fit_.begin(way, unit_rad_, config_.stamp_slack);
  }
  if (from_rest || without_ramps) {
    track_.follow(way);
  } else {
    track_.roam();
  }
  target_ = way.target;
  move_speed_ = request.speed_ps;
  status_.move = way.profile;
  status_.begun = way.begun;
  status_.moving = true;
}

void PtuAxis::on_halted(Stamp now) noexcept {
  request_.reset();
  status_.moving = false;
  ramp_fit_.cancel();
  if (!track_.resting()) {
    track_.roam();
    due_ = now;
  }
}

void PtuAxis::on_poll_sent(Stamp now) noexcept {
  dither_ += dither_ + kDitherStep < 1.0 ? kDitherStep : kDitherStep - 1.0;
  const double poll_hz = track_.resting() ? config_.rest_poll_hz : config_.poll_hz;
  const Stamp period = from_seconds((1.0 + kDitherShare * (dither_ - 0.5)) / poll_hz);
  due_ += period;
  if (due_ <= now) {
    due_ = now + period;
  }
}

bool PtuAxis::on_sighting(const PtuSighting& sighting, Stamp now) noexcept {
  const bool was_resting = track_.resting();
  if (!was_resting && sighting.half_width > config_.half_width_max) {
    counters_.count(PtuEvent::PositionsUnproven);
    due_ = now;
    return true;
  }
  ramp_fit_.add(sighting);
  const PtuJudgement judgement = track_.judge(sighting);
  if (judgement.earlier) {
    deliver(*judgement.earlier);
  }
  switch (judgement.verdict) {
    case PtuVerdict::Believed:
      deliver(sighting);
      break;
    case PtuVerdict::Held:
      break;
    case PtuVerdict::Unproven:
      counters_.count(PtuEvent::PositionsUnproven);
      status_.position_rad = sighting.position * unit_rad_;
      status_.polled = sighting.stamp;
      break;
    case PtuVerdict::Implausible:
      counters_.count(PtuEvent::PositionsImplausible);
      due_ = now;
      break;
    case PtuVerdict::Stuck:
      counters_.count(PtuEvent::PositionsImplausible);
      track_.rest(sighting.position);
      break;
    case PtuVerdict::Lost:
      counters_.count(PtuEvent::PositionsImplausible);
      return false;
  }
  if (!was_resting && track_.resting()) {
    end_move();
  }
  return true;
}

void PtuAxis::deliver(const PtuSighting& sighting) noexcept {
  const AxisSample sample{sighting.stamp, sighting.half_width, sighting.position * unit_rad_, axis_};
  status_.position_rad = sample.position_rad;
  status_.polled = sample.stamp;
  counters_.count(PtuEvent::PositionsDropped, samples_.try_push(sample) ? 0 : 1);
}

void PtuAxis::end_move() noexcept {
  counters_.count(PtuEvent::MovesLost, status_.moving && track_.position() != target_ ? 1 : 0);
  if (track_.position() == target_) {
    judge_ramp();
  }
  status_.moving = false;
  move_speed_ = 0;
}

/// One move may have been held up on its way; the next one shows whether it was that.
void PtuAxis::judge_ramp() noexcept {
  const std::optional<PtuRampFit::Result> result = ramp_fit_.end(info_.dynamics);
  if (!result) {
    return;
  }
  if (!result->is_off) {
    ramps_off_ = 0;
    ramp_ = learnt_ ? PtuRamp::Learnt : PtuRamp::AsTold;
    return;
  }
  if (++ramps_off_ < kRampsOff) {
    return;
  }
  ramps_off_ = 0;
  ramp_ = result->better ? PtuRamp::Learnt : PtuRamp::Unknown;
  if (result->better) {
    counters_.count(PtuEvent::ProfilesLearnt);
    learnt_ = result->better;
    use(*learnt_);
  }
}

void PtuAxis::use(const AxisDynamics& dynamics) noexcept {
  info_.dynamics = dynamics;
  facts_.base_speed_ps =
      static_cast<std::int32_t>(std::lround(dynamics.base_speed_radps / facts_.position_rad));
  facts_.acceleration_ps2 = dynamics.acceleration_radps2 / facts_.position_rad;
}

/// Where a moving axis should be at `when`.
std::int32_t PtuAxis::position_at(Stamp when) const noexcept {
  const double position_rad =
      status_.moving ? status_.move.position_rad(to_seconds(when - status_.begun)) : status_.position_rad;
  return std::clamp(static_cast<std::int32_t>(std::lround(position_rad / unit_rad_)), facts_.min_position,
                    facts_.max_position);
}

}  // namespace slamsensor::hal
