#include "tools/emulator/canopen/drive_control.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::uint16_t kEnableVoltage = 0x0002;
constexpr std::uint16_t kNoQuickStop = 0x0004;
constexpr std::uint16_t kFaultReset = 0x0080;

std::uint16_t state_bits(PowerState state) noexcept {
  switch (state) {
    case PowerState::NotReady:
      return 0x0000;
    case PowerState::SwitchOnDisabled:
      return 0x0250;
    case PowerState::ReadyToSwitchOn:
      return 0x0231;
    case PowerState::SwitchedOn:
      return 0x0233;
    case PowerState::OperationEnabled:
      return 0x0237;
    case PowerState::QuickStopActive:
      return 0x0217;
    case PowerState::FaultReaction:
      return 0x021F;
    case PowerState::Fault:
      break;
  }
  return 0x0218;
}

bool has_power(PowerState state) noexcept {
  return state == PowerState::OperationEnabled || state == PowerState::QuickStopActive ||
         state == PowerState::FaultReaction;
}

}  // namespace

void DriveControl::start(Stamp now) {
  axis_.freeze(now);
  state_ = PowerState::SwitchOnDisabled;
  next_state_.reset();
  word_ = 0;
  mode_ = 0;
  error_ = {};
  report_.reset();
  is_jammed_ = false;
  jammed_at_ = hal::kNever;
  running_.reset();
  buffered_.reset();
  is_acknowledged_ = false;
  is_limited_ = false;
  homing_ = Homing::Idle;
  step_at_ = hal::kNever;
}

void DriveControl::cut(Stamp now) {
  start(now);
  held_until_ = Stamp{};
  knows_zero_ = settings_.memory == DriveMemory::Absolute;
  state_ = PowerState::NotReady;
}

void DriveControl::set_controlword(std::uint16_t word, Stamp now) {
  const auto rising = static_cast<std::uint16_t>(word & ~word_);
  const auto falling = static_cast<std::uint16_t>(word_ & ~word);
  word_ = word;
  if ((rising & kFaultReset) != 0 && state_ == PowerState::Fault) {
    if (now >= held_until_) {
      error_ = {};
      report_ = error_;
      state_ = PowerState::SwitchOnDisabled;
    }
    return;
  }
  const bool was_enabled = state_ == PowerState::OperationEnabled;
  change_state(word, now);
  if (state_ == PowerState::OperationEnabled && was_enabled && !is_jammed_) {
    obey_mode(word, static_cast<std::uint16_t>(rising | falling), now);
  }
}

void DriveControl::change_state(std::uint16_t word, Stamp now) {
  if (state_ == PowerState::Fault || state_ == PowerState::FaultReaction || state_ == PowerState::NotReady) {
    return;
  }
  if ((word & kEnableVoltage) == 0) {
    return leave_power(PowerState::SwitchOnDisabled, now);
  }
  if ((word & kNoQuickStop) == 0) {
    return quick_stop(now);
  }
  const bool switches_on = (word & 1U) != 0;
  const bool enables = (word & 8U) != 0;
  if (!switches_on) {
    if (state_ != PowerState::QuickStopActive) {
      leave_power(PowerState::ReadyToSwitchOn, now);
    }
  } else if (state_ == PowerState::QuickStopActive) {
    if (enables) {
      enable(now);
    }
  } else if (state_ == PowerState::OperationEnabled && !enables) {
    ramp_to(PowerState::SwitchedOn, objects_.value(object::kDeceleration), now);
  } else if (state_ == PowerState::OperationEnabled) {
    next_state_.reset();
  } else if (state_ != PowerState::SwitchOnDisabled) {
    state_ = PowerState::SwitchedOn;
    if (enables) {
      enable(now);
    }
  }
}

void DriveControl::leave_power(PowerState state, Stamp now) {
  if (has_power(state_)) {
    axis_.freeze(now);
    running_.reset();
    buffered_.reset();
    homing_ = homing_ == Homing::Running ? Homing::Idle : homing_;
    step_at_ = hal::kNever;
    is_jammed_ = false;
    jammed_at_ = hal::kNever;
  }
  next_state_.reset();
  state_ = state;
}

void DriveControl::enable(Stamp now) {
  next_state_.reset();
  state_ = PowerState::OperationEnabled;
  last_target_ = axis_.position(now);
  is_limited_ = false;
  if (mode_ == 3) {
    set_target_velocity(now);
  }
}

void DriveControl::ramp_to(PowerState state, std::int64_t deceleration, Stamp now) {
  if (next_state_ == state) {
    return;
  }
  running_.reset();
  buffered_.reset();
  homing_ = homing_ == Homing::Running ? Homing::Idle : homing_;
  axis_.stop(now, static_cast<double>(deceleration));
  next_state_ = state;
  step_at_ = axis_.settled_at();
}

void DriveControl::quick_stop(Stamp now) {
  if (state_ == PowerState::ReadyToSwitchOn || state_ == PowerState::SwitchedOn) {
    state_ = PowerState::SwitchOnDisabled;
  }
  if (state_ != PowerState::OperationEnabled) {
    return;
  }
  const std::int64_t option = objects_.value(object::kQuickStopOption);
  if (option == 0) {
    return leave_power(PowerState::SwitchOnDisabled, now);
  }
  const bool is_slow = option == 1 || option == 5;
  const bool stays = option >= 5;
  state_ = PowerState::QuickStopActive;
  next_state_.reset();
  ramp_to(stays ? PowerState::QuickStopActive : PowerState::SwitchOnDisabled,
          objects_.value(is_slow ? object::kDeceleration : object::kQuickStop), now);
}

void DriveControl::fail(const DriveError& error, Stamp now, Stamp held_until) {
  if (state_ == PowerState::Fault || state_ == PowerState::FaultReaction || state_ == PowerState::NotReady) {
    return;
  }
  error_ = error;
  report_ = error;
  held_until_ = held_until;
  if (has_power(state_) && axis_.is_moving(now)) {
    state_ = PowerState::FaultReaction;
    next_state_.reset();
    ramp_to(PowerState::Fault, objects_.value(object::kQuickStop), now);
  } else {
    leave_power(PowerState::Fault, now);
  }
}

void DriveControl::jam(Stamp now) {
  if (!has_power(state_) || is_jammed_) {
    return;
  }
  const Stamp away = axis_.gets_away(now, number(object::kFollowingWindow));
  axis_.freeze(now);
  is_jammed_ = true;
  jammed_at_ = away == hal::kNever ? now : away;
}

Stamp DriveControl::next_event() const {
  return is_jammed_ ? jammed_at_ : std::min(step_at_, axis_.stop_hit());
}

void DriveControl::step(Stamp now) {
  if (axis_.stop_hit() <= now) {
    jam(now);
  }
  if (jammed_at_ <= now) {
    state_ == PowerState::FaultReaction ? leave_power(PowerState::Fault, now)
                                        : fail({0x8611, 0x21}, now, now);
    return;
  }
  if (step_at_ > now || is_jammed_) {
    return;
  }
  step_at_ = hal::kNever;
  if (next_state_) {
    const PowerState state = *next_state_;
    state == PowerState::QuickStopActive ? next_state_.reset() : leave_power(state, now);
  } else if (homing_ == Homing::Running) {
    end_homing(now);
  } else if (mode_ == 3) {
    watch_limit(now);
  } else if (running_ && is_ready(now) && (word_ & 0x0100U) == 0) {
    running_.reset();
    if (buffered_) {
      const SetPoint next = *buffered_;
      buffered_.reset();
      begin_set_point(next, now);
      is_acknowledged_ = (word_ & 0x0010U) != 0;
    }
  }
}

std::uint16_t DriveControl::statusword(Stamp now) const {
  const auto bits = static_cast<std::uint16_t>(state_bits(state_) | mode_bits(now));
  return static_cast<std::uint16_t>(bits | (is_limited_ ? 0x0800U : 0U));
}

std::optional<DriveError> DriveControl::take_report() {
  const std::optional<DriveError> report = report_;
  report_.reset();
  return report;
}

// The modes of operation of DriveControl.

namespace {

constexpr std::int8_t kPosition = 1;
constexpr std::int8_t kVelocity = 3;
constexpr std::int8_t kHoming = 6;

constexpr std::uint16_t kStart = 0x0010;
constexpr std::uint16_t kImmediately = 0x0020;
constexpr std::uint16_t kRelative = 0x0040;
constexpr std::uint16_t kHalt = 0x0100;

constexpr std::uint16_t kReached = 0x0400;
constexpr std::uint16_t kModeBit12 = 0x1000;
constexpr std::uint16_t kModeBit13 = 0x2000;

constexpr double kFar = 2147483647.0;

}  // namespace

void DriveControl::set_mode(std::int8_t mode, Stamp now) {
  if (mode == mode_) {
    return;
  }
  mode_ = mode;
  homing_ = Homing::Idle;
  is_acknowledged_ = false;
  is_limited_ = false;
  running_.reset();
  buffered_.reset();
  if (state_ != PowerState::OperationEnabled || next_state_ || is_jammed_) {
    return;
  }
  last_target_ = axis_.position(now);
  if (mode == kVelocity) {
    set_target_velocity(now);
  } else if (axis_.is_moving(now)) {
    axis_.stop(now, number(object::kDeceleration));
    step_at_ = axis_.settled_at();
  }
}

DriveRates DriveControl::rates(std::int64_t speed) const {
  return {static_cast<double>(speed), number(object::kAcceleration), number(object::kDeceleration)};
}

// No software limits when both are 0.
double DriveControl::bounded(double target) {
  const double lower = number(object::kLowerLimit);
  const double upper = number(object::kUpperLimit);
  is_limited_ = (lower != 0.0 || upper != 0.0) && (target < lower || target > upper);
  return is_limited_ ? std::clamp(target, lower, upper) : target;
}

void DriveControl::set_target_velocity(Stamp now) {
  if (state_ != PowerState::OperationEnabled || mode_ != kVelocity || next_state_ || is_jammed_ ||
      (word_ & kHalt) != 0) {
    return;
  }
  const std::int64_t velocity = objects_.value(object::kTargetVelocity);
  if (velocity == 0) {
    is_limited_ = false;
    axis_.stop(now, number(object::kDeceleration));
  } else {
    const double bound = bounded(velocity < 0 ? -kFar : kFar);
    // Beyond the limit already: there is no way on in this direction.
    const bool is_beyond = velocity < 0 ? bound >= axis_.position(now) : bound <= axis_.position(now);
    is_limited_ = is_beyond;
    is_beyond ? axis_.stop(now, number(object::kDeceleration))
              : axis_.run(now, bound, rates(std::abs(velocity)));
  }
  step_at_ = axis_.settled_at();
}

// A velocity has been reached, or the limit on the way.
void DriveControl::watch_limit(Stamp now) {
  if ((word_ & kHalt) != 0 || objects_.value(object::kTargetVelocity) == 0) {
    return;
  }
  if (axis_.is_moving(now)) {
    step_at_ = axis_.still_from();
  } else {
    is_limited_ = true;
  }
}

void DriveControl::obey_mode(std::uint16_t word, std::uint16_t changed, Stamp now) {
  if (next_state_) {
    return;
  }
  if ((changed & kHalt) != 0) {
    (word & kHalt) != 0 ? halt(now) : go_on(now);
  }
  const bool starts = (changed & word & kStart) != 0;
  const bool ends = (changed & ~word & kStart) != 0;
  if (mode_ == kPosition && starts) {
    take_set_point(word, now);
  } else if (mode_ == kPosition && ends) {
    is_acknowledged_ = buffered_.has_value();
  } else if (mode_ == kHoming && starts && (word & kHalt) == 0) {
    begin_homing(now);
  } else if (mode_ == kHoming && ends && homing_ == Homing::Running) {
    halt(now);
  }
}

void DriveControl::halt(Stamp now) {
  homing_ = homing_ == Homing::Running ? Homing::Idle : homing_;
  axis_.stop(now, number(object::kDeceleration));
  step_at_ = axis_.settled_at();
}

void DriveControl::go_on(Stamp now) {
  if (mode_ == kVelocity) {
    set_target_velocity(now);
  } else if (running_) {
    begin_set_point(SetPoint(*running_), now);
  }
}

void DriveControl::take_set_point(std::uint16_t word, Stamp now) {
  const bool is_now = (word & kImmediately) != 0;
  if (buffered_ && !is_now) {
    return;  // no room: not acknowledged anew
  }
  const double base = (word & kRelative) != 0 ? last_target_ : 0.0;
  const double wanted = base + number(object::kTarget);
  const bool was_limited = is_limited_;
  SetPoint point{bounded(wanted), rates(objects_.value(object::kProfileSpeed))};
  last_target_ = point.target;
  is_acknowledged_ = true;
  if (running_ && !is_now) {
    is_limited_ = was_limited;
    buffered_ = point;
    return;
  }
  buffered_.reset();
  begin_set_point(point, now);
  // bounded() has said whether the new target was cut.
  is_limited_ = point.target != wanted;
}

void DriveControl::begin_set_point(const SetPoint& point, Stamp now) {
  running_ = point;
  if ((word_ & kHalt) != 0) {
    return;
  }
  axis_.move(now, point.target, point.rates);
  step_at_ = axis_.settled_at();
}

void DriveControl::begin_homing(Stamp now) {
  is_limited_ = false;
  const HomingRates homing{number(object::kHomingFast), number(object::kHomingSlow),
                           number(object::kHomingAcceleration)};
  const bool knows = axis_.home(now, objects_.value(object::kHomingMethod), homing);
  homing_ = knows ? Homing::Running : Homing::Failed;
  knows_zero_ = false;
  step_at_ = knows ? axis_.settled_at() : hal::kNever;
}

// Home is where the home offset is (CiA 402, home offset).
void DriveControl::end_homing(Stamp now) {
  homing_ = Homing::Done;
  knows_zero_ = true;
  axis_.set_position(now, number(object::kHomeOffset));
  last_target_ = number(object::kHomeOffset);
}

std::uint16_t DriveControl::mode_bits(Stamp now) const {
  if (state_ == PowerState::Fault || state_ == PowerState::FaultReaction) {
    return error_.code == 0x8611 && mode_ == kPosition ? kModeBit13 : 0;
  }
  if (state_ != PowerState::OperationEnabled && state_ != PowerState::QuickStopActive) {
    return 0;
  }
  const bool is_reached = is_ready(now) && !is_jammed_ && step_at_ > now;
  std::uint32_t bits = is_reached ? kReached : 0U;
  if (mode_ == kPosition) {
    bits |= is_acknowledged_ ? kModeBit12 : 0U;
  } else if (mode_ == kVelocity) {
    bits &= is_limited_ ? 0U : kReached;
    bits |= axis_.is_moving(now) ? 0U : kModeBit12;
  } else if (mode_ == kHoming) {
    bits &= homing_ == Homing::Running ? 0U : kReached;
    bits |= homing_ == Homing::Done || knows_zero_ ? kModeBit12 : 0U;
    bits |= homing_ == Homing::Failed ? kModeBit13 : 0U;
  }
  return static_cast<std::uint16_t>(bits);
}

}  // namespace slamsensor::tools
