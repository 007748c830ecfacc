#include "firmware/scan/axis_move.hpp"

#include <cmath>

namespace slamsensor::firmware {
namespace {

constexpr double kThereSteps = 0.75;  // a whole position is told as itself

bool is_at(const hal::AxisStatus& status, double target_rad, double resolution_rad) noexcept {
  return std::abs(status.position_rad - target_rad) <= kThereSteps * resolution_rad;
}

}  // namespace

AxisMove::AxisMove(hal::Axis axis, double target_rad, double speed_radps, hal::Stamp margin) noexcept
    : axis_(axis),
      target_rad_(target_rad),
      speed_radps_(speed_radps),
      margin_(margin),
      state_(AxisMoveState::Asking) {
}

AxisMoveState AxisMove::step(hal::PanTilt& unit, hal::Stamp now) noexcept {
  if (state_ == AxisMoveState::Asking) {
    ask(unit, now);
  } else if (state_ == AxisMoveState::Moving) {
    const hal::PanTiltInfo& info = unit.info();
    const hal::AxisInfo& axis = axis_ == hal::Axis::Pan ? info.pan : info.tilt;
    watch(unit.axis(axis_), axis.resolution_rad, now);
  }
  return state_;
}

void AxisMove::ask(hal::PanTilt& unit, hal::Stamp now) noexcept {
  const hal::AxisStatus& status = unit.axis(axis_);
  const hal::AxisInfo& axis = axis_ == hal::Axis::Pan ? unit.info().pan : unit.info().tilt;
  if (deadline_ == hal::kNever) {
    deadline_ = now + margin_;
    asked_ = now;
    start_rad_ = status.position_rad;
  }
  seen_rad_ = status.position_rad;
  waited_ = now - asked_;
  if (!status.moving && status.polled > hal::Stamp{} && is_at(status, target_rad_, axis.resolution_rad)) {
    state_ = AxisMoveState::Arrived;
    return;
  }
  switch (unit.move(axis_, target_rad_, speed_radps_)) {
    case hal::MoveStatus::Accepted: {
      const hal::MotionProfile expected(status.position_rad, target_rad_, speed_radps_, axis.dynamics);
      taken_ = now;
      deadline_ = now + hal::from_seconds(expected.duration_s()) + margin_;
      state_ = AxisMoveState::Moving;
      return;
    }
    case hal::MoveStatus::OutOfRange:
      state_ = AxisMoveState::Refused;
      return;
    case hal::MoveStatus::Busy:
    case hal::MoveStatus::NotReady:
      break;
  }
  if (now >= deadline_) {
    state_ = AxisMoveState::Stalled;
  }
}

void AxisMove::watch(const hal::AxisStatus& status, double resolution_rad, hal::Stamp now) noexcept {
  has_moved_ = has_moved_ || status.moving;
  seen_rad_ = status.position_rad;
  waited_ = now - asked_;
  const bool rests = !status.moving && status.polled >= taken_;
  if (rests && is_at(status, target_rad_, resolution_rad)) {
    state_ = AxisMoveState::Arrived;
  } else if ((rests && has_moved_) || now >= deadline_) {
    state_ = AxisMoveState::Stalled;  // until it has moved, the command may still be on its way
  }
}

}  // namespace slamsensor::firmware
