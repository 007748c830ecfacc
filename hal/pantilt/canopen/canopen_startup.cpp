#include "hal/pantilt/canopen/canopen_startup.hpp"

#include "hal/pantilt/canopen/cia402.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::hal {
namespace {

constexpr std::uint32_t kDriveProfile = 402;  // low half of the device type

constexpr std::array<SdoAddress, 14> kAsked{
    object::kDeviceType,     object::kVendor,        object::kProduct,       object::kDeviceName,
    object::kSupportedModes, object::kPositionMin,   object::kPositionMax,   object::kSpeedMax,
    object::kProfileSpeed,   object::kAcceleration,  object::kEncoderCounts, object::kEncoderTurns,
    object::kGearMotorTurns, object::kGearShaftTurns};

/// Objects that only FromDrive needs come last and are not asked otherwise.
constexpr std::size_t kWithoutScale = 10;

constexpr bool is_same(SdoAddress a, SdoAddress b) noexcept {
  return a == b;
}

}  // namespace

void CanopenFactsScript::begin(Stamp) noexcept {
  static_assert(kAsked.size() == kReads);
  at_ = 0;
  values_ = {};
  facts_ = {};
}

std::optional<SdoRequest> CanopenFactsScript::next() const noexcept {
  const std::size_t count = axis_.scale == CanopenScale::FromDrive ? kReads : kWithoutScale;
  if (at_ >= count) {
    return std::nullopt;
  }
  SdoRequest request = SdoRequest::read(kAsked[at_]);
  if (is_same(request.address, object::kDeviceName)) {
    request.kind = SdoRequest::Kind::ReadText;
  }
  return request;
}

CanopenProblem CanopenFactsScript::on_result(const SdoResult& result, const SdoClient& client,
                                             Stamp) noexcept {
  const SdoAddress asked = result.request.address;
  const bool done = result.outcome == SdoOutcome::Done;
  if (is_same(asked, object::kDeviceType) && (!done || (result.value & 0xFFFFU) != kDriveProfile)) {
    return CanopenProblem::NotADrive;
  }
  if (is_same(asked, object::kDeviceName) && done) {
    facts_.name = client.text();
  }
  if (done) {
    values_[at_] = result.value;
  } else {
    counters_.count(CanopenEvent::SettingsRefused);
  }
  ++at_;
  return next() ? CanopenProblem::None : conclude();
}

/// What is optional in a drive has its bound in the configuration.
CanopenProblem CanopenFactsScript::conclude() noexcept {
  const std::uint32_t assumed = 1U;  // a drive that does not report its modes has the usual one
  facts_.modes = reported(object::kSupportedModes).value_or(assumed);
  const bool sweeps_by_speed = config_.motion == CanopenMotion::ProfileVelocity;
  if (!has_mode(facts_.modes, DriveMode::ProfilePosition) ||
      (sweeps_by_speed && !has_mode(facts_.modes, DriveMode::ProfileVelocity)) ||
      (config_.homing == CanopenHoming::Always && !has_mode(facts_.modes, DriveMode::Homing))) {
    return CanopenProblem::NoMode;
  }
  const double counts_per_rad = scale();
  if (!(counts_per_rad >= 1e-3 && counts_per_rad <= 1e12)) {
    return CanopenProblem::NoScale;
  }
  facts_.rad_per_count = (axis_.sense == CanopenSense::Normal ? 1.0 : -1.0) / counts_per_rad;
  facts_.speed_units_per_rad = axis_.speed_units_per_rad > 0.0 ? axis_.speed_units_per_rad : counts_per_rad;
  const double window = std::min(std::round(axis_.window_rad * counts_per_rad), 1e9);
  facts_.window_counts = std::max(1, static_cast<std::int32_t>(window));

  AxisInfo& info = facts_.info;
  info.resolution_rad = 1.0 / counts_per_rad;
  info.speed_min_radps = 1.0 / facts_.speed_units_per_rad;
  const std::uint32_t speed_units = reported(object::kSpeedMax).value_or(0);
  const double speed_reported = speed_units / facts_.speed_units_per_rad;
  info.speed_max_radps =
      speed_units > 0 ? std::min(speed_reported, axis_.speed_max_radps) : axis_.speed_max_radps;
  const double per_rad =
      axis_.acceleration_units_per_rad > 0.0 ? axis_.acceleration_units_per_rad : counts_per_rad;
  info.dynamics.acceleration_radps2 = axis_.acceleration_radps2 > 0.0
                                          ? axis_.acceleration_radps2
                                          : reported(object::kAcceleration).value_or(0) / per_rad;
  // Without any acceleration known, speed is taken to be reached at once.
  info.dynamics.base_speed_radps = info.dynamics.acceleration_radps2 > 0.0 ? 0.0 : info.speed_max_radps;
  return find_range();
}

CanopenProblem CanopenFactsScript::find_range() noexcept {
  AxisInfo& info = facts_.info;
  info.min_rad = axis_.min_rad;
  info.max_rad = axis_.max_rad;
  const auto low = static_cast<std::int32_t>(reported(object::kPositionMin).value_or(0));
  const auto high = static_cast<std::int32_t>(reported(object::kPositionMax).value_or(0));
  if (low < high) {  // both 0, or crossed: no limits (CiA 402)
    const double a = low * facts_.rad_per_count;
    const double b = high * facts_.rad_per_count;
    info.min_rad = std::max(info.min_rad, std::min(a, b));
    info.max_rad = std::min(info.max_rad, std::max(a, b));
  }
  return info.min_rad < info.max_rad ? CanopenProblem::None : CanopenProblem::NoLimits;
}

/// Counts per radian of the axis.
double CanopenFactsScript::scale() const noexcept {
  if (axis_.scale == CanopenScale::Configured) {
    return axis_.counts_per_rad;
  }
  const double counts = reported(object::kEncoderCounts).value_or(0);
  const double turns = reported(object::kEncoderTurns).value_or(1);
  const double motor = reported(object::kGearMotorTurns).value_or(1);
  const double shaft = reported(object::kGearShaftTurns).value_or(1);
  return turns > 0.0 && shaft > 0.0 ? counts / turns * motor / shaft / (2.0 * std::numbers::pi) : 0.0;
}

std::optional<std::uint32_t> CanopenFactsScript::reported(SdoAddress address) const noexcept {
  for (std::size_t i = 0; i < kAsked.size(); ++i) {
    if (is_same(kAsked[i], address)) {
      return values_[i];
    }
  }
  return std::nullopt;
}

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

CanopenStartup::CanopenStartup(const CanopenConfig& config, const CanopenAxisConfig& axis, CanLink& link,
                               SdoClient& sdo, CanopenCounters& counters) noexcept
    : config_(config),
      axis_(axis),
      link_(link),
      sdo_(sdo),
      counters_(counters),
      facts_(config, axis, counters),
      settings_(config, axis, counters),
      receive_(PdoDirection::Receive, axis.node, config, counters),
      transmit_(PdoDirection::Transmit, axis.node, config, counters),
      enable_(config),
      reference_(config, axis) {
}

void CanopenStartup::begin(Stamp now) noexcept {
  enter(Stage::Stop, now);
}

CanopenProblem CanopenStartup::step(Stamp now) noexcept {
  if (stage_ == Stage::Stop || stage_ == Stage::Start) {
    step_nmt(stage_ == Stage::Stop ? NmtCommand::PreOperational : NmtCommand::Start, now);
    return CanopenProblem::None;
  }
  CanopenScript* const part = script();
  if (part == nullptr) {
    return CanopenProblem::None;
  }
  if (const std::optional<SdoResult> result = sdo_.take()) {
    const CanopenProblem problem = result->outcome == SdoOutcome::TimedOut
                                       ? CanopenProblem::NoReply
                                       : part->on_result(*result, sdo_, now);
    if (problem != CanopenProblem::None) {
      return problem;
    }
  }
  if (!sdo_.is_idle()) {
    return CanopenProblem::None;
  }
  if (const std::optional<SdoRequest> request = part->next()) {
    sdo_.begin(*request, now);
  } else {
    enter(static_cast<Stage>(static_cast<std::uint8_t>(stage_) + 1), now);
  }
  return CanopenProblem::None;
}

CanopenScript* CanopenStartup::script() noexcept {
  switch (stage_) {
    case Stage::Facts:
      return &facts_;
    case Stage::Settings:
      return &settings_;
    case Stage::Receive:
      return &receive_;
    case Stage::Transmit:
      return &transmit_;
    case Stage::Enable:
      return &enable_;
    case Stage::Reference:
      return &reference_;
    case Stage::Stop:
    case Stage::Start:
    case Stage::Done:
      break;
  }
  return nullptr;
}

void CanopenStartup::enter(Stage stage, Stamp now) noexcept {
  stage_ = stage;
  nmt_sent_ = false;
  if (stage == Stage::Settings) {
    const double own = axis_.acceleration_units_per_rad;
    settings_.set_scale(own > 0.0 ? own : 1.0 / facts().info.resolution_rad);
  }
  if (stage == Stage::Reference) {
    reference_.set_modes(facts().modes);
  }
  if (CanopenScript* const part = script()) {
    part->begin(now);
  }
}

/// A node confirms no such command; it is given time to act on it.
void CanopenStartup::step_nmt(NmtCommand command, Stamp now) noexcept {
  if (!nmt_sent_) {
    nmt_sent_ = link_.send(nmt_frame(command, axis_.node)) == LinkStatus::Ok;
    counters_.count(CanopenEvent::SendsBusy, nmt_sent_ ? 0 : 1);
    resume_ = now + config_.boot_wait;
  } else if (now >= resume_) {
    enter(static_cast<Stage>(static_cast<std::uint8_t>(stage_) + 1), now);
  }
}

}  // namespace slamsensor::hal
