#include "hal/pantilt/canopen/canopen_drive.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::hal {
namespace {

constexpr std::uint8_t kAttempts = 3;  // of a set-point
constexpr Stamp kOvertime = std::chrono::seconds(2);

}  // namespace

CanopenDrive::CanopenDrive(Axis axis, const CanopenConfig& config, const CanopenStartup& startup,
                           CanLink& link, SdoClient& sdo, CanopenCounters& counters,
                           CanopenSamples& samples) noexcept
    : axis_(axis),
      config_(config),
      startup_(startup),
      link_(link),
      sdo_(sdo),
      counters_(counters),
      samples_(samples) {
}

void CanopenDrive::set_up(Stamp now) noexcept {
  status_ = {};
  phase_ = Phase::Rest;
  request_.reset();
  requests_.clear();
  unsent_.reset();
  speed_set_ = 0;
  at_once_ = true;  // whatever the drive was doing is replaced
  swept_ = false;
  halt_due_ = false;
  command_out_ = false;
  seen_ = {};
  status_.position_rad = startup_.position() * startup_.facts().rad_per_count;
  standing_rad_ = status_.position_rad;
  seen_.position = startup_.position();
  seen_.statusword = 0x0027;  // as the start-up left it
  latest_sync_ = earlier_sync_ = paired_sync_ = -Stamp(1);
  last_seen_ = now;
  next_poll_ = now;
  next_rest_ = now;
  status_next_ = true;
}

void CanopenDrive::forget() noexcept {
  if (phase_ != Phase::Rest) {
    const std::uint8_t node = axis_ == Axis::Pan ? config_.pan.node : config_.tilt.node;
    // Past the queue of requests: whatever it was waiting for no longer matters.
    const std::uint32_t halted = control::kEnable | control::kHaltBit;
    if (link_.send(sdo_write(node, object::kControlword, halted, 2)) != LinkStatus::Ok) {
      counters_.count(CanopenEvent::SendsBusy);
    }
  }
  phase_ = Phase::Rest;
  request_.reset();
  requests_.clear();
  unsent_.reset();
  status_ = {};
}

MoveStatus CanopenDrive::ask(double target_rad, double speed_radps) noexcept {
  const CanopenFacts& facts = startup_.facts();
  const double half = 0.5 * facts.info.resolution_rad;
  const bool target_fits = target_rad >= facts.info.min_rad - half && target_rad <= facts.info.max_rad + half;
  const double units = std::round(speed_radps * facts.speed_units_per_rad);
  const bool speed_fits =
      units >= 1.0 && units <= 2147483647.0 && speed_radps <= facts.info.speed_max_radps * (1.0 + 1e-9);
  const double counts = std::round(target_rad / facts.rad_per_count);
  if (!target_fits || !speed_fits || !(std::abs(counts) <= 2147483647.0)) {
    return MoveStatus::OutOfRange;
  }
  if (request_) {
    return MoveStatus::Busy;
  }
  request_ =
      Request{static_cast<std::int32_t>(counts), target_rad, static_cast<std::uint32_t>(units), speed_radps};
  return MoveStatus::Accepted;
}

void CanopenDrive::halt() noexcept {
  request_.reset();
  requests_.clear();
  phase_ = Phase::Halting;
  halt_due_ = true;
}

CanopenProblem CanopenDrive::step(Stamp now) noexcept {
  send_waiting();
  const CanopenProblem refused = step_sdo(now);
  step_motion(now);
  return refused != CanopenProblem::None ? refused : judge(now);
}

void CanopenDrive::step_motion(Stamp now) noexcept {
  switch (phase_) {
    case Phase::Rest:
    case Phase::Moving:
    case Phase::Sweep:
      if (request_) {
        at_once_ = at_once_ || phase_ != Phase::Rest;
        attempts_ = 0;
        swept_ = false;
        prepare();
      } else if (phase_ != Phase::Rest && now > give_up_at_) {
        give_up();
      }
      break;
    case Phase::Prepare:
      if (is_sent()) {
        raise_set_point(now);
      }
      break;
    case Phase::SetPoint:
      step_set_point(now);
      break;
    case Phase::Release:
      if ((seen_.stamp > sent_at_ && (seen_.statusword & status::kAcknowledge) == 0 && is_sent()) ||
          now - sent_at_ > config_.acknowledge_timeout) {
        phase_ = Phase::Moving;
      }
      break;
    case Phase::Halting:
      start_halt(now);
      break;
  }
}

/// Queues what must be set before the drive is told to go.
void CanopenDrive::prepare() noexcept {
  phase_ = Phase::Prepare;
  if (request_) {
    move_ = *request_;
  }
  if (config_.motion == CanopenMotion::ProfileVelocity && !swept_) {
    const bool forward = move_.target >= seen_.position;
    const auto speed = static_cast<std::int32_t>(move_.speed_units);
    queue(SdoRequest::write(object::kTargetSpeed, static_cast<std::uint32_t>(forward ? speed : -speed), 4));
    queue(SdoRequest::write(object::kControlword, control::kEnable, 2));
    queue(SdoRequest::write(object::kMode, static_cast<std::uint32_t>(DriveMode::ProfileVelocity), 1));
    return;
  }
  if (config_.motion == CanopenMotion::ProfileVelocity) {
    queue(SdoRequest::write(object::kMode, static_cast<std::uint32_t>(DriveMode::ProfilePosition), 1));
  }
  if (speed_set_ != move_.speed_units) {
    queue(SdoRequest::write(object::kProfileSpeed, move_.speed_units, 4));
  }
}

/// What prepare() queued is confirmed: in a sweep the axis now runs, else its set-point is given.
void CanopenDrive::raise_set_point(Stamp now) noexcept {
  if (config_.motion == CanopenMotion::ProfileVelocity && !swept_) {
    begin_status(acted_.value_or(now));
    phase_ = Phase::Sweep;
    at_once_ = true;
    request_.reset();
    return;
  }
  speed_set_ = move_.speed_units;
  const auto start = static_cast<std::uint16_t>(control::kEnable | control::kStartBit);
  phase_ = Phase::SetPoint;
  command(at_once_ ? static_cast<std::uint16_t>(start | control::kImmediatelyBit) : start, now);
}

void CanopenDrive::step_set_point(Stamp now) noexcept {
  const bool acknowledged =
      is_sent() && seen_.stamp > sent_at_ && (seen_.statusword & status::kAcknowledge) != 0;
  if (acknowledged) {
    if (!swept_) {
      begin_status(acted_.value_or(now));
    }
    request_.reset();
    at_once_ = false;
    phase_ = Phase::Release;
    command(control::kEnable, now);
    return;
  }
  if (now - sent_at_ <= config_.acknowledge_timeout) {
    return;
  }
  command(control::kEnable, now);
  if (++attempts_ >= kAttempts) {
    counters_.count(CanopenEvent::MovesRejected);
    request_.reset();
    come_to_rest();
    at_once_ = true;
    return;
  }
  counters_.count(CanopenEvent::MovesRepeated);
  prepare();
}

/// Halts once, then waits for the standstill that bit 10 tells while the halt bit is set.
void CanopenDrive::start_halt(Stamp now) noexcept {
  if (halt_due_) {
    halt_due_ = false;
    command(control::kEnable | control::kHaltBit, now);
    at_once_ = true;
    return;
  }
  const bool stands = is_sent() && seen_.stamp > sent_at_ && (seen_.statusword & status::kTargetReached) != 0;
  if (stands || now - sent_at_ > config_.state_timeout) {
    come_to_rest();
  }
}

/// What reports tell from here on is where the next move starts: by the time that it is confirmed, reports
/// may already be of an axis under way.
void CanopenDrive::come_to_rest() noexcept {
  phase_ = Phase::Rest;
  status_.moving = false;
  standing_rad_ = status_.position_rad;
}

void CanopenDrive::begin_status(Stamp begun) noexcept {
  const double start_rad =
      status_.moving ? status_.move.position_rad(to_seconds(begun - status_.begun)) : standing_rad_;
  status_.move =
      MotionProfile(start_rad, move_.target_rad, move_.speed_radps, startup_.facts().info.dynamics);
  status_.begun = begun;
  status_.moving = true;
  on_target_ = 0;
  const double duration_s = std::min(status_.move.duration_s(), 1e6);
  give_up_at_ = begun + from_seconds(1.5 * duration_s) + kOvertime;
}

/// The axis should long have been there.
void CanopenDrive::give_up() noexcept {
  counters_.count(CanopenEvent::MovesLost);
  halt();
}

/// Sends `controlword` with the target; the PDO carries both at once.
void CanopenDrive::command(std::uint16_t controlword, Stamp now) noexcept {
  const PdoMap& map = startup_.command_map();
  sent_at_ = now;
  acted_.reset();
  if (!map.is_present) {
    if ((controlword & control::kStartBit) != 0) {
      queue(SdoRequest::write(object::kTarget, static_cast<std::uint32_t>(move_.target), 4));
    }
    queue(SdoRequest::write(object::kControlword, controlword, 2));
    return;
  }
  CanFrame frame{.id = map.cob_id, .size = map.size};
  put_le(frame, map.word_at, 2, controlword);
  put_le(frame, map.value_at, 4, static_cast<std::uint32_t>(move_.target));
  unsent_ = frame;
  send_waiting();
  if (!map.is_sync) {
    acted_ = now;
  }
}

void CanopenDrive::queue(const SdoRequest& request) noexcept {
  // Never full: a phase queues at most 5 and waits for them.
  counters_.count(CanopenEvent::MovesLost, requests_.try_push(request) ? 0 : 1);
}

bool CanopenDrive::is_sent() const noexcept {
  return !unsent_ && requests_.size() == 0 && !command_out_;
}

void CanopenDrive::send_waiting() noexcept {
  if (unsent_) {
    if (link_.send(*unsent_) == LinkStatus::Ok) {
      unsent_.reset();
    } else {
      counters_.count(CanopenEvent::SendsBusy);
    }
  }
}

void CanopenDrive::on_sync(Stamp sent) noexcept {
  earlier_sync_ = latest_sync_;
  latest_sync_ = sent;
  if (!acted_ && !unsent_ && startup_.command_map().is_sync && sent >= sent_at_) {
    acted_ = sent;
  }
}

}  // namespace slamsensor::hal
