// The modes of operation of DriveControl.
#include "tools/emulator/canopen/drive_control.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
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
  if (state_ != DriveState::OperationEnabled || next_state_ || is_jammed_) {
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
  if (state_ != DriveState::OperationEnabled || mode_ != kVelocity || next_state_ || is_jammed_ ||
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
  if (is_limited_ && settings_.limit_rule == DriveLimitRule::Refuse) {
    return;
  }
  last_target_ = point.target;
  is_acknowledged_ = true;
  if (running_ && !is_now) {
    is_limited_ = was_limited;
    buffered_ = point;
    return;
  }
  buffered_.reset();
  begin_set_point(point, now);
  // bounded() has told whether the new target was cut.
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
  if (state_ == DriveState::Fault || state_ == DriveState::FaultReaction) {
    return error_.code == 0x8611 && mode_ == kPosition ? kModeBit13 : 0;
  }
  if (state_ != DriveState::OperationEnabled && state_ != DriveState::QuickStopActive) {
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
    const bool remembers = settings_.homed_bit == DriveHomedBit::WhileTrue && knows_zero_;
    bits |= homing_ == Homing::Done || remembers ? kModeBit12 : 0U;
    bits |= homing_ == Homing::Failed ? kModeBit13 : 0U;
  }
  return static_cast<std::uint16_t>(bits);
}

}  // namespace slamsensor::tools
