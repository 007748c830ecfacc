#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"

#include <algorithm>
#include <utility>

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
  const auto reported = static_cast<NmtState>(got.frame.data[0] & 0x7FU);
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
  } else if (was_ready && reported != NmtState::Operational) {
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

namespace {

constexpr std::size_t kFramesPerStep = 256;  // 25 ms of a full bus at 1 Mbit/s

constexpr std::string_view kBusDown =
    "CANopen pan-tilt unit: the CAN bus is down; check the interface, its cable and its termination";

}  // namespace

tl::expected<std::unique_ptr<CanopenPanTilt>, InitError> CanopenPanTilt::create(const CanopenConfig& config,
                                                                                CanLink& link) {
  if (std::optional<InitError> error = canopen_config_error(config)) {
    return tl::unexpected(std::move(*error));
  }
  return std::unique_ptr<CanopenPanTilt>(new CanopenPanTilt(config, link));
}

CanopenPanTilt::CanopenPanTilt(const CanopenConfig& config, CanLink& link) noexcept
    : config_(config),
      link_(link),
      pan_(Axis::Pan, config_, link, counters_, samples_),
      tilt_(Axis::Tilt, config_, link, counters_, samples_) {
}

void CanopenPanTilt::step(Stamp now) noexcept {
  if (!link_ready(now)) {
    return;
  }
  receive(now);
  pan_.step(now);
  tilt_.step(now);
  send_sync(now);
  update_state();
}

std::string_view CanopenPanTilt::problem() const noexcept {
  if (state_ == DeviceState::Ready) {
    return {};
  }
  if (state_ == DeviceState::Absent) {
    return link_.problem().empty() ? kBusDown : link_.problem();
  }
  // The axis in the worse state is the one to look at first.
  const bool tilt_first = pan_.state() == DeviceState::Ready ||
                          (tilt_.state() == DeviceState::Faulted && pan_.state() != DeviceState::Faulted);
  return tilt_first ? problem_text(Axis::Tilt, tilt_.problem()) : problem_text(Axis::Pan, pan_.problem());
}

MoveStatus CanopenPanTilt::move(Axis axis, double target_rad, double speed_radps) noexcept {
  MoveStatus result = MoveStatus::NotReady;
  if (state_ == DeviceState::Ready) {
    result = (axis == Axis::Pan ? pan_ : tilt_).drive().ask(target_rad, speed_radps);
  }
  counters_.count(CanopenEvent::MovesRefused, result == MoveStatus::Accepted ? 0 : 1);
  return result;
}

MoveStatus CanopenPanTilt::halt() noexcept {
  if (state_ != DeviceState::Ready) {
    counters_.count(CanopenEvent::MovesRefused);
    return MoveStatus::NotReady;
  }
  pan_.drive().halt();
  tilt_.drive().halt();
  return MoveStatus::Accepted;
}

const AxisStatus& CanopenPanTilt::axis(Axis axis) const noexcept {
  return (axis == Axis::Pan ? pan_ : tilt_).drive().status();
}

bool CanopenPanTilt::link_ready(Stamp now) noexcept {
  link_.service(now);
  if (!link_.is_up()) {
    if (state_ != DeviceState::Absent) {
      pan_.lose_link();
      tilt_.lose_link();
      state_ = DeviceState::Absent;
    }
    return false;
  }
  if (epoch_ != link_.epoch() || state_ == DeviceState::Absent) {
    counters_.count(CanopenEvent::Restarts, epoch_ != 0 ? 2 : 0);
    epoch_ = link_.epoch();
    pan_.begin(now);
    tilt_.begin(now);
    state_ = DeviceState::Starting;
  }
  return true;
}

void CanopenPanTilt::receive(Stamp now) noexcept {
  for (std::size_t i = 0; i < kFramesPerStep; ++i) {
    const CanRead got = link_.receive();
    if (got.status != LinkStatus::Ok) {
      return;
    }
    pan_.on_frame(got, now);
    tilt_.on_frame(got, now);
  }
}

/// Keeps the beat of the SYNC; after a pause it begins anew instead of catching up.
void CanopenPanTilt::send_sync(Stamp now) noexcept {
  if ((!pan_.wants_sync() && !tilt_.wants_sync()) || now < next_sync_) {
    return;
  }
  if (link_.send(CanFrame{.id = cob::kSync}) != LinkStatus::Ok) {
    counters_.count(CanopenEvent::SendsBusy);
    return;
  }
  const Stamp period = from_seconds(1.0 / config_.poll_hz);
  const bool begun = next_sync_ != Stamp::min();
  const bool late = begun && now - next_sync_ >= period;
  counters_.count(CanopenEvent::SyncsLate, late ? 1 : 0);
  next_sync_ = begun && !late ? next_sync_ + period : now + period;
  pan_.on_sync(now);
  tilt_.on_sync(now);
}

void CanopenPanTilt::update_state() noexcept {
  const bool ready = pan_.state() == DeviceState::Ready && tilt_.state() == DeviceState::Ready;
  const bool faulted = pan_.state() == DeviceState::Faulted || tilt_.state() == DeviceState::Faulted;
  const DeviceState before = state_;
  state_ = ready ? DeviceState::Ready : faulted ? DeviceState::Faulted : DeviceState::Starting;
  if (ready && before != DeviceState::Ready) {
    info_.pan = pan_.facts().info;
    info_.tilt = tilt_.facts().info;
    info_.model = pan_.facts().name;
  }
  if (!ready && before == DeviceState::Ready) {
    samples_.clear();
    // One axis alone is of no use: the other stops, too.
    for (CanopenNode* node : {&pan_, &tilt_}) {
      if (node->state() == DeviceState::Ready) {
        node->drive().halt();
      }
    }
  }
}

}  // namespace slamsensor::hal
