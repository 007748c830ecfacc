#include "hal/pantilt/canopen/canopen_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamsensor::hal {
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
