#include "hal/pantilt/canopen/canopen_node.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kEmergencyBytes = 8;

/// Whether a retry by itself can help; the others wait for a person, and are tried again all the same.
bool is_fault(CanopenProblem problem) noexcept {
  return problem != CanopenProblem::NoReply && problem != CanopenProblem::HeartbeatLost &&
         problem != CanopenProblem::BootUp && problem != CanopenProblem::NotOperational &&
         problem != CanopenProblem::NotEnabled && problem != CanopenProblem::PositionsSilent;
}

}  // namespace

CanopenNode::CanopenNode(Axis axis, const CanopenConfig& config, CanLink& link, CanopenCounters& counters,
                         CanopenSamples& samples) noexcept
    : config_(config),
      axis_(axis == Axis::Pan ? config.pan : config.tilt),
      counters_(counters),
      sdo_(axis_.node, config, link, counters),
      startup_(config, axis_, link, sdo_, counters),
      drive_(axis, config, startup_, link, sdo_, counters, samples) {
}

void CanopenNode::begin(Stamp now) noexcept {
  drive_.forget();
  sdo_.reset();
  startup_.begin(now);
  state_ = DeviceState::Starting;
  waiting_ = false;
  retry_wait_ = Stamp{};
}

void CanopenNode::lose_link() noexcept {
  drive_.forget();
  state_ = DeviceState::Starting;
  problem_ = CanopenProblem::NotTried;
}

void CanopenNode::step(Stamp now) noexcept {
  sdo_.step(now);
  if (waiting_) {
    // An answer that comes now is of no use, but ends the request.
    static_cast<void>(sdo_.take());
    if (now < retry_at_ || !sdo_.is_idle()) {
      return;
    }
    waiting_ = false;
    counters_.count(CanopenEvent::Restarts);
    startup_.begin(now);
  }
  if (state_ == DeviceState::Ready) {
    const CanopenProblem watched = watch(now);
    const CanopenProblem problem = watched != CanopenProblem::None ? watched : drive_.step(now);
    if (problem != CanopenProblem::None) {
      fail(problem, now);
    }
    return;
  }
  const CanopenProblem problem = startup_.step(now);
  if (problem != CanopenProblem::None) {
    fail(problem, now);
  } else if (startup_.is_done()) {
    state_ = DeviceState::Ready;
    problem_ = CanopenProblem::None;
    retry_wait_ = Stamp{};
    heard_ = now;
    drive_.set_up(now);
  }
}

void CanopenNode::on_frame(const CanRead& got, Stamp now) noexcept {
  if (got.frame.extended) {
    return;
  }
  if (got.frame.id == cob::kSdoReply + axis_.node) {
    sdo_.on_frame(got, now);
  } else if (got.frame.id == cob::kHeartbeat + axis_.node) {
    on_heartbeat(got, now);
  } else if (got.frame.id == cob::kEmergency + axis_.node) {
    on_emergency(got, now);
  } else if (state_ == DeviceState::Ready && startup_.position_map().is_present &&
             got.frame.id == startup_.position_map().cob_id) {
    drive_.on_pdo(got);
  }
}

bool CanopenNode::wants_sync() const noexcept {
  return startup_.is_operational() && (startup_.position_map().is_sync || startup_.command_map().is_sync);
}

void CanopenNode::fail(CanopenProblem problem, Stamp now) noexcept {
  drive_.forget();
  problem_ = problem;
  state_ = is_fault(problem) ? DeviceState::Faulted : DeviceState::Starting;
  retry_wait_ =
      retry_wait_ == Stamp{} ? config_.retry_first : std::min(retry_wait_ * 2, config_.retry_longest);
  retry_at_ = now + retry_wait_;
  waiting_ = true;
}

void CanopenNode::on_heartbeat(const CanRead& got, Stamp now) noexcept {
  if (got.frame.bytes().size() != 1) {
    counters_.count(CanopenEvent::FramesMalformed);
    return;
  }
  heard_ = now;
  const auto told = static_cast<NmtState>(got.frame.data[0] & 0x7FU);
  const bool was_ready = state_ == DeviceState::Ready;
  if (got.frame.data[0] == static_cast<std::uint8_t>(NmtState::BootUp)) {
    // All that was set is gone, and with it every answer still to come.
    counters_.count(CanopenEvent::BootUps, was_ready ? 1 : 0);
    sdo_.reset();
    if (was_ready) {
      fail(CanopenProblem::BootUp, now);
    } else {
      waiting_ = true;
    }
    retry_at_ = now + config_.boot_wait;
  } else if (was_ready && told != NmtState::Operational) {
    counters_.count(CanopenEvent::StatesLost);
    fail(CanopenProblem::NotOperational, now);
  }
}

void CanopenNode::on_emergency(const CanRead& got, Stamp now) noexcept {
  if (got.frame.bytes().size() != kEmergencyBytes) {
    counters_.count(CanopenEvent::FramesMalformed);
    return;
  }
  const auto code = static_cast<std::uint16_t>(le_number(got.frame, 0, 2));
  const std::uint8_t error_register = got.frame.data[2];
  if (code == 0) {
    return;  // the end of an error
  }
  counters_.count(CanopenEvent::Emergencies);
  if (state_ == DeviceState::Ready && error_register != 0) {
    fail(emergency_problem(code), now);
  }
}

CanopenProblem CanopenNode::watch(Stamp now) noexcept {
  if (startup_.has_heartbeat() && now - heard_ > config_.heartbeat_timeout) {
    counters_.count(CanopenEvent::HeartbeatsLost);
    return CanopenProblem::HeartbeatLost;
  }
  return CanopenProblem::None;
}

}  // namespace slamsensor::hal
