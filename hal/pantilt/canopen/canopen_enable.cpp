#include "hal/pantilt/canopen/canopen_enable.hpp"

#include "hal/pantilt/canopen/cia402.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::hal {
namespace {

constexpr int kChanges = 8;  // of state on the longest way, with room: one that goes in circles is given up

}  // namespace

void CanopenEnableScript::begin(Stamp now) noexcept {
  done_ = false;
  write_due_ = false;
  command_.reset();
  begun_ = now;
  since_ = now;
}

std::optional<SdoRequest> CanopenEnableScript::next() const noexcept {
  if (done_) {
    return std::nullopt;
  }
  return write_due_ && command_ ? SdoRequest::write(object::kControlword, *command_, 2)
                                : SdoRequest::read(object::kStatusword);
}

CanopenProblem CanopenEnableScript::on_result(const SdoResult& result, const SdoClient&, Stamp now) noexcept {
  if (result.outcome == SdoOutcome::Aborted) {
    return abort_problem(result.value);
  }
  if (write_due_) {
    write_due_ = false;
    since_ = now;
    return CanopenProblem::None;
  }
  return on_status(result.value, now);
}

CanopenProblem CanopenEnableScript::on_status(std::uint32_t statusword, Stamp now) noexcept {
  const DriveState state = drive_state(statusword);
  if (state == DriveState::OperationEnabled && command_ == control::kEnable) {
    done_ = true;
    return CanopenProblem::None;
  }
  const bool is_fault = state == DriveState::Fault;
  if (is_fault && config_.fault_reset == CanopenFaultReset::Never) {
    return CanopenProblem::DriveFault;
  }
  const bool too_long =
      now - since_ > config_.state_timeout || now - begun_ > kChanges * config_.state_timeout;
  if (too_long) {
    return is_fault ? CanopenProblem::DriveFault : CanopenProblem::StateTimeout;
  }
  const bool passing =
      state == DriveState::NotReady || state == DriveState::FaultReaction || state == DriveState::Unknown;
  std::uint16_t wanted = towards_enabled(state);
  if (is_fault && command_ != control::kFaultReset) {
    // The reset is a rising edge, so its bit must be known to be low before.
    wanted = command_ == control::kDisableVoltage ? control::kFaultReset : control::kDisableVoltage;
  }
  if (!passing && command_ != wanted) {
    command_ = wanted;
    write_due_ = true;
  }
  return CanopenProblem::None;
}

void CanopenSettingsScript::begin(Stamp) noexcept {
  step_ = 0;
  has_heartbeat_ = false;
}

std::optional<SdoRequest> CanopenSettingsScript::next() const noexcept {
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(config_.heartbeat).count();
  const double units = std::clamp(std::round(axis_.acceleration_radps2 * scale_), 1.0, 4e9);
  const auto acceleration = static_cast<std::uint32_t>(units);
  switch (step_) {
    case 0:
      return SdoRequest::write(object::kHeartbeatTime, static_cast<std::uint32_t>(milliseconds), 2);
    case 1:
      return SdoRequest::write(object::kMode, static_cast<std::uint32_t>(DriveMode::ProfilePosition), 1);
    case 2:
    case 3:
      if (axis_.acceleration_radps2 > 0.0) {
        return SdoRequest::write(step_ == 2 ? object::kAcceleration : object::kDeceleration, acceleration, 4);
      }
      break;
    default:
      break;
  }
  return std::nullopt;
}

CanopenProblem CanopenSettingsScript::on_result(const SdoResult& result, const SdoClient&, Stamp) noexcept {
  const bool done = result.outcome == SdoOutcome::Done;
  if (step_ == 0) {
    has_heartbeat_ = done;
    counters_.count(CanopenEvent::SettingsRefused, done ? 0 : 1);
  } else if (!done) {
    return abort_problem(result.value);
  }
  ++step_;
  return CanopenProblem::None;
}

}  // namespace slamsensor::hal
