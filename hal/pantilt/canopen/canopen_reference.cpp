#include "hal/pantilt/canopen/canopen_reference.hpp"

#include "hal/pantilt/canopen/cia402.hpp"

namespace slamsensor::hal {
namespace {

/// Bits left over from an earlier homing are believed only when they last for this long after the start.
constexpr Stamp kStaleBits = std::chrono::milliseconds(100);

constexpr std::uint32_t kAttained = status::kTargetReached | status::kAcknowledge;

/// Zero is where the axis happens to stand (CiA 402, homing methods 35 and 37).
bool is_here(std::int8_t method) noexcept {
  return method == 35 || method == 37;
}

SdoRequest mode_request(DriveMode mode) noexcept {
  return SdoRequest::write(object::kMode, static_cast<std::uint32_t>(mode), 1);
}

}  // namespace

void CanopenReferenceScript::begin(Stamp now) noexcept {
  const bool homes = config_.homing != CanopenHoming::Never && has_mode(modes_, DriveMode::Homing);
  enter(homes ? Step::HomingMode : Step::Mode, now);
}

std::optional<SdoRequest> CanopenReferenceScript::next() const noexcept {
  switch (step_) {
    case Step::HomingMode:
      return mode_request(DriveMode::Homing);
    case Step::HomingShown:
    case Step::ModeShown:
      return SdoRequest::read(object::kModeDisplay);
    case Step::Homed:
    case Step::Wait:
      return SdoRequest::read(object::kStatusword);
    case Step::Method:
      return SdoRequest::write(object::kHomingMethod, static_cast<std::uint8_t>(axis_.homing_method), 1);
    case Step::Start:
      return SdoRequest::write(object::kControlword, control::kEnable | control::kStartBit, 2);
    case Step::End:
      return SdoRequest::write(object::kControlword, control::kEnable, 2);
    case Step::Mode:
      return mode_request(DriveMode::ProfilePosition);
    case Step::Position:
      return SdoRequest::read(object::kPosition);
    case Step::Done:
      break;
  }
  return std::nullopt;
}

CanopenProblem CanopenReferenceScript::on_result(const SdoResult& result, const SdoClient&,
                                                 Stamp now) noexcept {
  const bool shown = step_ == Step::HomingShown || step_ == Step::ModeShown;
  if (result.outcome == SdoOutcome::Aborted && !shown) {
    return abort_problem(result.value);
  }
  switch (step_) {
    case Step::HomingShown:
      return on_shown(result, Step::Homed, now);
    case Step::Homed:
      if ((result.value & status::kAcknowledge) == 0 || config_.homing == CanopenHoming::Always) {
        return start_homing(now);
      }
      enter(Step::Mode, now);
      break;
    case Step::Wait:
      return on_homing(result.value, now);
    case Step::ModeShown:
      return on_shown(result, Step::Position, now);
    case Step::Position:
      position_ = result.signed_value();
      had_zero_ = true;
      enter(Step::Done, now);
      break;
    case Step::HomingMode:
    case Step::Method:
    case Step::Start:
    case Step::End:
    case Step::Mode:
      enter(static_cast<Step>(static_cast<std::uint8_t>(step_) + 1), now);
      break;
    case Step::Done:
      break;
  }
  return CanopenProblem::None;
}

void CanopenReferenceScript::enter(Step step, Stamp now) noexcept {
  step_ = step;
  since_ = now;
  was_busy_ = false;
}

/// A drive without a mode display is taken at its word.
CanopenProblem CanopenReferenceScript::on_shown(const SdoResult& result, Step next, Stamp now) noexcept {
  const DriveMode wanted = step_ == Step::HomingShown ? DriveMode::Homing : DriveMode::ProfilePosition;
  if (result.outcome == SdoOutcome::Aborted || result.value == static_cast<std::uint32_t>(wanted)) {
    enter(next, now);
    return CanopenProblem::None;
  }
  return now - since_ > config_.state_timeout ? CanopenProblem::StateTimeout : CanopenProblem::None;
}

/// Another zero than before would turn every heading by what the axis was turned: rather no fix.
CanopenProblem CanopenReferenceScript::start_homing(Stamp now) noexcept {
  if (axis_.homing_method == 0) {
    return CanopenProblem::NotHomed;
  }
  if (had_zero_ && is_here(axis_.homing_method)) {
    return CanopenProblem::ZeroLost;
  }
  enter(Step::Method, now);
  return CanopenProblem::None;
}

CanopenProblem CanopenReferenceScript::on_homing(std::uint32_t statusword, Stamp now) noexcept {
  const DriveState state = drive_state(statusword);
  if (state != DriveState::OperationEnabled) {
    const bool fault = state == DriveState::Fault || state == DriveState::FaultReaction;
    return fault ? CanopenProblem::DriveFault : CanopenProblem::NotEnabled;
  }
  const bool believed = was_busy_ || now - since_ >= kStaleBits;
  if (believed && (statusword & status::kError) != 0) {
    return CanopenProblem::HomingFailed;
  }
  if ((statusword & kAttained) != kAttained) {
    was_busy_ = was_busy_ || (statusword & status::kError) == 0;
  } else if (believed) {
    enter(Step::End, now);
    return CanopenProblem::None;
  }
  return now - since_ > config_.homing_timeout ? CanopenProblem::HomingTimeout : CanopenProblem::None;
}

}  // namespace slamsensor::hal
