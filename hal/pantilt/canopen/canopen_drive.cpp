#include "hal/pantilt/canopen/canopen_drive.hpp"

#include <algorithm>
#include <array>
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

/// Queues what must be set before the drive is commanded to go.
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

/// Halts once, then waits for the standstill that bit 10 reports while the halt bit is set.
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

/// Positions reported from here on are where the next move starts: by the time that it is confirmed, reports
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

namespace {

constexpr std::uint8_t kOnTarget = 2;  // sightings in a row that make the end of a move

}  // namespace

/// One request at a time: commands first, then polls where no PDO brings positions.
CanopenProblem CanopenDrive::step_sdo(Stamp now) noexcept {
  CanopenProblem problem = CanopenProblem::None;
  if (const std::optional<SdoResult> result = sdo_.take()) {
    problem = on_result(*result);
  }
  if (!sdo_.is_idle()) {
    return problem;
  }
  std::array<SdoRequest, 1> next{};
  if (requests_.take(next) == 1) {
    sdo_.begin(next[0], now);
    command_out_ = true;
  } else if (polls_by_sdo(now)) {
    sdo_.begin(SdoRequest::read(status_next_ ? object::kStatusword : object::kPosition), now);
    if (!status_next_) {
      next_poll_ = now + from_seconds(1.0 / config_.poll_hz);
    }
    status_next_ = !status_next_;
  }
  return problem;
}

CanopenProblem CanopenDrive::on_result(const SdoResult& result) noexcept {
  command_out_ = false;
  if (result.outcome == SdoOutcome::TimedOut) {
    return CanopenProblem::NoReply;
  }
  const Stamp half = (result.received - result.sent) / 2;
  if (result.outcome == SdoOutcome::Aborted) {
    if (result.request.kind != SdoRequest::Kind::Write) {
      return abort_problem(result.value);
    }
    counters_.count(CanopenEvent::MovesRejected);
    requests_.clear();
    request_.reset();
    halt();
    return CanopenProblem::None;
  }
  if (result.request.kind == SdoRequest::Kind::Write) {
    if (!startup_.command_map().is_present || phase_ == Phase::Prepare) {
      acted_ = result.sent + half;
      sent_at_ = result.received;
    }
  } else if (result.request.address == object::kStatusword) {
    seen_.statusword = static_cast<std::uint16_t>(result.value);
    seen_.stamp = result.sent + half;
  } else if (result.request.address == object::kPosition) {
    on_sighting({result.sent + half, half, seen_.statusword, result.signed_value()});
  }
  return CanopenProblem::None;
}

/// A position PDO sent on events says nothing of an axis at rest; then it is asked.
bool CanopenDrive::polls_by_sdo(Stamp now) const noexcept {
  const PdoMap& map = startup_.position_map();
  if (map.is_present && map.is_sync) {
    return false;
  }
  const Stamp rest = from_seconds(1.0 / config_.rest_poll_hz);
  if (map.is_present) {
    return !status_next_ || now - last_seen_ >= std::min(rest, config_.position_timeout / 4);
  }
  return !status_next_ || now >= next_poll_;
}

void CanopenDrive::on_pdo(const CanRead& got) noexcept {
  const PdoMap& map = startup_.position_map();
  if (!map.is_present || got.frame.bytes().size() != map.size) {
    counters_.count(CanopenEvent::FramesMalformed);
    return;
  }
  DriveSighting sighting{got.stamp, config_.sync_half_width, 0, 0};
  if (map.is_sync) {
    // One that arrived before the latest SYNC was sent belongs to the one before.
    const Stamp sync = got.stamp >= latest_sync_ ? latest_sync_ : earlier_sync_;
    if (sync < Stamp{} || got.stamp < sync || sync == paired_sync_) {
      counters_.count(CanopenEvent::PositionsUnpaired);
      return;
    }
    paired_sync_ = sync;
    sighting.stamp = sync;
  }
  sighting.statusword = static_cast<std::uint16_t>(le_number(got.frame, map.word_at, 2));
  sighting.position = static_cast<std::int32_t>(le_number(got.frame, map.value_at, 4));
  on_sighting(sighting);
}

void CanopenDrive::on_sighting(const DriveSighting& sighting) noexcept {
  seen_ = sighting;
  last_seen_ = sighting.stamp;
  status_.position_rad = sighting.position * startup_.facts().rad_per_count;
  status_.polled = sighting.stamp;
  if (phase_ == Phase::Rest) {
    standing_rad_ = status_.position_rad;
  }
  if (phase_ != Phase::Rest || sighting.stamp >= next_rest_) {
    next_rest_ = sighting.stamp + from_seconds(1.0 / config_.rest_poll_hz);
    const AxisSample sample{sighting.stamp, sighting.half_width, status_.position_rad, axis_};
    counters_.count(CanopenEvent::PositionsDropped, samples_.try_push(sample) ? 0 : 1);
  }
  if (phase_ == Phase::Moving) {
    heed_end(sighting);
  } else if (phase_ == Phase::Sweep && sighting.stamp > status_.begun) {
    heed_sweep(sighting);
  }
}

/// A move has ended when the drive says so and stands at the target, twice.
void CanopenDrive::heed_end(const DriveSighting& sighting) noexcept {
  const auto away = std::abs(static_cast<std::int64_t>(sighting.position) - move_.target);
  const bool there = sighting.stamp > sent_at_ && (sighting.statusword & status::kTargetReached) != 0 &&
                     away <= startup_.facts().window_counts;
  on_target_ = there ? static_cast<std::uint8_t>(on_target_ + 1) : std::uint8_t{0};
  if (on_target_ >= kOnTarget) {
    come_to_rest();
  }
}

/// Hands a sweep over to a set-point in time to stop at the target.
void CanopenDrive::heed_sweep(const DriveSighting& sighting) noexcept {
  const AxisDynamics& dynamics = startup_.facts().info.dynamics;
  const double speed = move_.speed_radps;
  const double braking_rad =
      dynamics.acceleration_radps2 > 0.0 ? 0.5 * speed * speed / dynamics.acceleration_radps2 : 0.0;
  // Three requests and a set-point, each up to a period or so.
  const double latency_rad = speed * (5.0 / config_.poll_hz);
  const double sign = move_.target_rad >= status_.move.start_rad() ? 1.0 : -1.0;
  const double left_rad = sign * (move_.target_rad - sighting.position * startup_.facts().rad_per_count);
  if (left_rad <= braking_rad + latency_rad && !request_) {
    swept_ = true;
    attempts_ = 0;
    prepare();
  }
}

/// Whether the drive still works and is heard of.
CanopenProblem CanopenDrive::judge(Stamp now) noexcept {
  const DriveState state = drive_state(seen_.statusword);
  if (state == DriveState::Fault || state == DriveState::FaultReaction) {
    counters_.count(CanopenEvent::Faults);
    return CanopenProblem::DriveFault;
  }
  if (state != DriveState::OperationEnabled) {
    counters_.count(CanopenEvent::StatesLost);
    return CanopenProblem::NotEnabled;
  }
  if (now - last_seen_ > config_.position_timeout) {
    counters_.count(CanopenEvent::PositionsSilent);
    return CanopenProblem::PositionsSilent;
  }
  return CanopenProblem::None;
}

}  // namespace slamsensor::hal
