#include "firmware/scan/scan_scheduler.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace slamsensor::firmware {
namespace {

// In the order of HoldReason.
constexpr std::array<std::string_view, kHoldReasons> kHolds = {
    "the laser interlock is open or cannot be read; close it to scan",
    "paused on command; resume to scan",
    "the inclinometer does not report how the sensor leans; check it, or set inclination.source",
    "the sensor leans by more than inclination.max_lean_deg; set it upright",
};

// In the order of ScanDoubt; an LCM status has room for 191 characters.
constexpr std::array<std::string_view, kScanDoubts> kDoubts = {
    "the timing of a device was in doubt during the scan",
    "the pan-tilt unit's positions are timed too loosely; check its line, or scan more slowly",
    "pan-tilt unit and rangefinder are not timed yet: too little is seen; or set latency.initial_s",
    "pan-tilt unit and rangefinder are apart in time by more than before; being measured anew",
};

}  // namespace

std::string_view describe(ScanDoubt doubt) noexcept {
  return kDoubts[static_cast<std::size_t>(doubt)];
}

std::string_view describe(HoldReason reason) noexcept {
  return kHolds[static_cast<std::size_t>(reason)];
}

namespace {

constexpr double kThereSteps = 0.75;  // a whole position is reported as itself

bool is_at(const hal::AxisStatus& status, double target_rad, double resolution_rad) noexcept {
  return std::abs(status.position_rad - target_rad) <= kThereSteps * resolution_rad;
}

// A resting axis is polled to within one position; one that a servo holds gives way a little.
constexpr double kPushedSteps = 2.5;
constexpr double kPushed_rad = 0.00175;

constexpr SchedulerEvent event_of(ScanAbort reason) noexcept {
  return static_cast<SchedulerEvent>(static_cast<std::uint8_t>(SchedulerEvent::AbortedPanTiltLost) +
                                     static_cast<std::uint8_t>(reason));
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

ScanScheduler::ScanScheduler(hal::PanTilt& pan_tilt, const hal::Rangefinder& rangefinder,
                             const ScanConfig& config) noexcept
    : pan_tilt_(pan_tilt),
      rangefinder_(rangefinder),
      config_(config),
      calibrated_(config.calibration_lines == 0),
      counters_({"scans_finished", "calibrations_finished", "scans_aborted_pan_tilt_lost",
                 "scans_aborted_rangefinder_lost", "scans_aborted_move_refused", "scans_aborted_pan_stalled",
                 "scans_aborted_tilt_stalled", "scans_aborted_lines_rejected", "scans_aborted_head_moved",
                 "scans_aborted_carrier_moved", "scans_aborted_timing_in_doubt", "scans_aborted_held",
                 "scans_aborted_cancelled", "plans_refused", "lines_swept", "holds_begun", "requests_joined",
                 "requests_cancelled"}) {
  set_mode(config.mode);
}

void ScanScheduler::request_scan() noexcept {
  if (requested_) {
    counters_.count(SchedulerEvent::RequestsJoined);
  }
  requested_ = true;
}

void ScanScheduler::set_mode(ScanMode mode) noexcept {
  config_.mode = mode;
  if (mode == ScanMode::OneShot) {
    request_scan();
  }
}

void ScanScheduler::abort_scan() noexcept {
  cancelled_ = state_ != SchedulerState::Waiting;
  if (requested_ || serves_request_) {
    counters_.count(SchedulerEvent::RequestsCancelled);
  }
  requested_ = serves_request_ = false;
}

void ScanScheduler::hold(HoldReason reason) noexcept {
  if (!held()) {
    counters_.count(SchedulerEvent::HoldsBegun);
    halt_due_ = true;
  }
  holds_[static_cast<std::size_t>(reason)] = true;
}

void ScanScheduler::release(HoldReason reason) noexcept {
  holds_[static_cast<std::size_t>(reason)] = false;
}

std::optional<HoldReason> ScanScheduler::held() const noexcept {
  const auto* const found = std::find(holds_.begin(), holds_.end(), true);
  return found == holds_.end() ? std::nullopt
                               : std::optional(static_cast<HoldReason>(std::distance(holds_.begin(), found)));
}

SchedulerAction ScanScheduler::step(hal::Stamp now, const SchedulerGates& gates) noexcept {
  if (state_ == SchedulerState::Waiting) {
    return wait(now);
  }
  if (const auto reason = find_abort()) {
    return abort(*reason, now);
  }
  switch (state_) {
    case SchedulerState::Waiting:
      break;
    case SchedulerState::Positioning:
      return position(now);
    case SchedulerState::Settling:
      return settle(now, gates);
    case SchedulerState::Sweeping:
      return sweep(now);
    case SchedulerState::Finishing:
      return finish(now, gates);
  }
  return SchedulerAction::None;
}

SchedulerAction ScanScheduler::wait(hal::Stamp now) noexcept {
  halt();
  const bool wanted = config_.mode == ScanMode::Continuous || requested_;
  if (!wanted || held() || now < until_ || pan_tilt_.state() != hal::DeviceState::Ready ||
      rangefinder_.state() != hal::DeviceState::Ready || is_timing_in_doubt()) {
    return SchedulerAction::None;
  }
  if (!make_plan()) {
    until_ = now + hal::from_seconds(config_.retry_s);
    return SchedulerAction::None;
  }
  const double pan_rad = pan_tilt_.axis(hal::Axis::Pan).position_rad;
  first_leftwards_ = std::abs(pan_rad - plan_.pan_min_rad) <= std::abs(pan_rad - plan_.pan_max_rad);
  lines_rejected_ = 0;
  carrier_moved_ = cancelled_ = false;
  pass_ = calibrated_ ? ScanPass::Scan : ScanPass::Calibration;
  if (pass_ == ScanPass::Scan) {
    serves_request_ = std::exchange(requested_, false);
  }
  begin_line(0);
  return SchedulerAction::PassBegun;
}

bool ScanScheduler::make_plan() noexcept {
  const auto plan = plan_scan(config_, pan_tilt_.info(), rangefinder_.info().rate_hz);
  if (!plan) {
    plan_problem_ = plan.error();
    counters_.count(SchedulerEvent::PlansRefused);
    return false;
  }
  plan_problem_.reset();
  plan_ = *plan;
  return true;
}

void ScanScheduler::begin_line(std::uint32_t line) noexcept {
  line_ = line;
  const double tilt_rad = pass_ == ScanPass::Calibration ? plan_.calibration_tilt_rad : plan_.tilt_rad(line);
  const hal::Stamp margin = hal::from_seconds(config_.move_margin_s);
  pan_ = AxisMove(hal::Axis::Pan, pan_start_rad(), plan_.pan_speed_radps, margin);
  tilt_ = AxisMove(hal::Axis::Tilt, tilt_rad, plan_.tilt_speed_radps, margin);
  state_ = SchedulerState::Positioning;
}

SchedulerAction ScanScheduler::position(hal::Stamp now) noexcept {
  const AxisMoveState pan = pan_.step(pan_tilt_, now);
  const AxisMoveState tilt = tilt_.step(pan_tilt_, now);
  if (pan == AxisMoveState::Arrived && tilt == AxisMoveState::Arrived) {
    until_ = now + hal::from_seconds(config_.settle_s);
    state_ = SchedulerState::Settling;
  }
  return SchedulerAction::None;
}

SchedulerAction ScanScheduler::settle(hal::Stamp now, const SchedulerGates& gates) noexcept {
  if (now < until_ || !gates.assembler_idle) {
    return SchedulerAction::None;
  }
  pan_ = AxisMove(hal::Axis::Pan, pan_end_rad(), plan_.pan_speed_radps,
                  hal::from_seconds(config_.move_margin_s));
  (void)pan_.step(pan_tilt_, now);
  state_ = SchedulerState::Sweeping;
  return SchedulerAction::LineBegun;
}

SchedulerAction ScanScheduler::sweep(hal::Stamp now) noexcept {
  if (pan_.step(pan_tilt_, now) != AxisMoveState::Arrived) {
    return SchedulerAction::None;
  }
  counters_.count(SchedulerEvent::LinesSwept);
  if (line_ + 1 < line_count()) {
    // The tilt goes up while late data comes in; the next sweep waits for the assembler.
    begin_line(line_ + 1);
  } else {
    state_ = SchedulerState::Finishing;
  }
  return SchedulerAction::LineEnded;
}

SchedulerAction ScanScheduler::finish(hal::Stamp now, const SchedulerGates& gates) noexcept {
  if (!gates.assembler_idle || !gates.latency_idle) {
    return SchedulerAction::None;
  }
  if (pass_ == ScanPass::Calibration) {
    counters_.count(SchedulerEvent::CalibrationsFinished);
    calibrated_ = true;
  } else {
    counters_.count(SchedulerEvent::ScansFinished);
    serves_request_ = false;
  }
  until_ = now;
  state_ = SchedulerState::Waiting;
  return SchedulerAction::PassEnded;
}

std::optional<ScanAbort> ScanScheduler::find_abort() const noexcept {
  if (pan_tilt_.state() != hal::DeviceState::Ready) {
    return ScanAbort::PanTiltLost;
  }
  if (rangefinder_.state() != hal::DeviceState::Ready) {
    return ScanAbort::RangefinderLost;
  }
  if (is_timing_in_doubt()) {
    return ScanAbort::TimingInDoubt;
  }
  if (held()) {
    return ScanAbort::Held;
  }
  if (cancelled_) {
    return ScanAbort::Cancelled;
  }
  if (pan_.state() == AxisMoveState::Refused || tilt_.state() == AxisMoveState::Refused) {
    return ScanAbort::MoveRefused;
  }
  if (pan_.state() == AxisMoveState::Stalled) {
    return ScanAbort::PanStalled;
  }
  if (tilt_.state() == AxisMoveState::Stalled) {
    return ScanAbort::TiltStalled;
  }
  if (rests_elsewhere()) {
    return ScanAbort::HeadMoved;
  }
  if (pass_ == ScanPass::Scan && carrier_moved_) {
    return ScanAbort::CarrierMoved;
  }
  if (pass_ == ScanPass::Scan && lines_rejected_ > config_.lines_rejected_max_share * plan_.lines) {
    return ScanAbort::LinesRejected;
  }
  return std::nullopt;
}

bool ScanScheduler::is_timing_in_doubt() const noexcept {
  return !pan_tilt_.timing_doubt().empty() || !rangefinder_.timing_doubt().empty();
}

/// Whether an axis that had arrived is not there any more.
bool ScanScheduler::rests_elsewhere() const noexcept {
  const auto is_off = [this](const AxisMove& move, hal::Axis axis, double resolution_rad) {
    const double off_rad = pan_tilt_.axis(axis).position_rad - move.target_rad();
    return move.state() == AxisMoveState::Arrived &&
           std::abs(off_rad) > std::max(kPushed_rad, kPushedSteps * resolution_rad);
  };
  return is_off(pan_, hal::Axis::Pan, plan_.pan_resolution_rad) ||
         is_off(tilt_, hal::Axis::Tilt, plan_.tilt_resolution_rad);
}

SchedulerAction ScanScheduler::abort(ScanAbort reason, hal::Stamp now) noexcept {
  abort_reason_ = reason;
  counters_.count(event_of(reason));
  requested_ = requested_ || std::exchange(serves_request_, false);
  until_ = reason == ScanAbort::Held ? now : now + hal::from_seconds(config_.retry_s);
  state_ = SchedulerState::Waiting;
  halt_due_ = true;
  halt();
  return SchedulerAction::PassAborted;
}

/// Until the unit has taken it. One that is not Ready moves nothing of its own; its next pass begins anew.
void ScanScheduler::halt() noexcept {
  if (halt_due_) {
    halt_due_ = pan_tilt_.state() == hal::DeviceState::Ready && pan_tilt_.halt() == hal::MoveStatus::Busy;
  }
}

std::uint32_t ScanScheduler::line_count() const noexcept {
  return pass_ == ScanPass::Calibration ? config_.calibration_lines : plan_.lines;
}

double ScanScheduler::pan_start_rad() const noexcept {
  return is_leftwards() ? plan_.pan_min_rad : plan_.pan_max_rad;
}

double ScanScheduler::pan_end_rad() const noexcept {
  return is_leftwards() ? plan_.pan_max_rad : plan_.pan_min_rad;
}

}  // namespace slamsensor::firmware
