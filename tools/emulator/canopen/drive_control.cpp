#include "tools/emulator/canopen/drive_control.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::uint16_t kEnableVoltage = 0x0002;
constexpr std::uint16_t kNoQuickStop = 0x0004;
constexpr std::uint16_t kFaultReset = 0x0080;

std::uint16_t state_bits(DriveState state) noexcept {
  switch (state) {
    case DriveState::NotReady:
      return 0x0000;
    case DriveState::SwitchOnDisabled:
      return 0x0250;
    case DriveState::ReadyToSwitchOn:
      return 0x0231;
    case DriveState::SwitchedOn:
      return 0x0233;
    case DriveState::OperationEnabled:
      return 0x0237;
    case DriveState::QuickStopActive:
      return 0x0217;
    case DriveState::FaultReaction:
      return 0x021F;
    case DriveState::Fault:
      break;
  }
  return 0x0218;
}

bool has_power(DriveState state) noexcept {
  return state == DriveState::OperationEnabled || state == DriveState::QuickStopActive ||
         state == DriveState::FaultReaction;
}

}  // namespace

void DriveControl::start(Stamp now) {
  axis_.freeze(now);
  state_ = DriveState::SwitchOnDisabled;
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
  state_ = DriveState::NotReady;
}

void DriveControl::set_controlword(std::uint16_t word, Stamp now) {
  const auto rising = static_cast<std::uint16_t>(word & ~word_);
  const auto falling = static_cast<std::uint16_t>(word_ & ~word);
  word_ = word;
  if ((rising & kFaultReset) != 0 && state_ == DriveState::Fault) {
    if (now >= held_until_) {
      error_ = {};
      report_ = error_;
      state_ = DriveState::SwitchOnDisabled;
    }
    return;
  }
  const bool was_enabled = state_ == DriveState::OperationEnabled;
  change_state(word, now);
  if (state_ == DriveState::OperationEnabled && was_enabled && !is_jammed_) {
    obey_mode(word, static_cast<std::uint16_t>(rising | falling), now);
  }
}

void DriveControl::change_state(std::uint16_t word, Stamp now) {
  if (state_ == DriveState::Fault || state_ == DriveState::FaultReaction || state_ == DriveState::NotReady) {
    return;
  }
  if ((word & kEnableVoltage) == 0) {
    return leave_power(DriveState::SwitchOnDisabled, now);
  }
  if ((word & kNoQuickStop) == 0) {
    return quick_stop(now);
  }
  const bool switches_on = (word & 1U) != 0;
  const bool enables = (word & 8U) != 0;
  if (!switches_on) {
    if (state_ != DriveState::QuickStopActive) {
      leave_power(DriveState::ReadyToSwitchOn, now);
    }
  } else if (state_ == DriveState::QuickStopActive) {
    if (enables) {
      enable(now);
    }
  } else if (state_ == DriveState::OperationEnabled && !enables) {
    ramp_to(DriveState::SwitchedOn, objects_.value(object::kDeceleration), now);
  } else if (state_ == DriveState::OperationEnabled) {
    next_state_.reset();
  } else if (state_ != DriveState::SwitchOnDisabled) {
    state_ = DriveState::SwitchedOn;
    if (enables) {
      enable(now);
    }
  }
}

void DriveControl::leave_power(DriveState state, Stamp now) {
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
  state_ = DriveState::OperationEnabled;
  last_target_ = axis_.position(now);
  is_limited_ = false;
  if (mode_ == 3) {
    set_target_velocity(now);
  }
}

void DriveControl::ramp_to(DriveState state, std::int64_t deceleration, Stamp now) {
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
  if (state_ == DriveState::ReadyToSwitchOn || state_ == DriveState::SwitchedOn) {
    state_ = DriveState::SwitchOnDisabled;
  }
  if (state_ != DriveState::OperationEnabled) {
    return;
  }
  const std::int64_t option = objects_.value(object::kQuickStopOption);
  if (option == 0) {
    return leave_power(DriveState::SwitchOnDisabled, now);
  }
  const bool is_slow = option == 1 || option == 5;
  const bool stays = option >= 5;
  state_ = DriveState::QuickStopActive;
  next_state_.reset();
  ramp_to(stays ? DriveState::QuickStopActive : DriveState::SwitchOnDisabled,
          objects_.value(is_slow ? object::kDeceleration : object::kQuickStop), now);
}

void DriveControl::fail(const DriveError& error, Stamp now, Stamp held_until) {
  if (state_ == DriveState::Fault || state_ == DriveState::FaultReaction || state_ == DriveState::NotReady) {
    return;
  }
  error_ = error;
  report_ = error;
  held_until_ = held_until;
  if (has_power(state_) && axis_.is_moving(now)) {
    state_ = DriveState::FaultReaction;
    next_state_.reset();
    ramp_to(DriveState::Fault, objects_.value(object::kQuickStop), now);
  } else {
    leave_power(DriveState::Fault, now);
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
    state_ == DriveState::FaultReaction ? leave_power(DriveState::Fault, now)
                                        : fail({0x8611, 0x21}, now, now);
    return;
  }
  if (step_at_ > now || is_jammed_) {
    return;
  }
  step_at_ = hal::kNever;
  if (next_state_) {
    const DriveState state = *next_state_;
    state == DriveState::QuickStopActive ? next_state_.reset() : leave_power(state, now);
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

}  // namespace slamsensor::tools
