#include "tools/emulator/canopen/emulated_drive.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::uint64_t kSdoStream = 201;
constexpr std::uint64_t kPdoStream = 202;
constexpr Stamp kMemory = std::chrono::seconds(2);  // of motion, for angle_rad()

constexpr std::uint32_t kSdoReply = 0x580;
constexpr std::uint32_t kSdoRequest = 0x600;
constexpr std::uint32_t kHeartbeat = 0x700;

}  // namespace

EmulatedDrive::EmulatedDrive(const DriveSettings& settings, FrameSink& sink, std::uint64_t seed)
    : settings_(settings),
      sink_(sink),
      defaults_(drive_objects(settings_)),
      objects_(defaults_),
      axis_(settings_),
      control_(settings_, objects_, axis_),
      sdo_(*this),
      power_(settings_.begin, settings_.boot_time),
      sdo_latency_(settings_.sdo_latency, mix_seed(seed, kSdoStream)),
      pdo_latency_(settings_.pdo_latency, mix_seed(seed, kPdoStream)) {
  if (settings_.memory == DriveMemory::Incremental) {
    axis_.set_position(Stamp{}, 0.0);
  }
  if (power_.is_up()) {
    control_.start(Stamp{});
    node_state_ = NodeState::PreOperational;
  }
}

Stamp EmulatedDrive::next_event() const {
  if (!power_.is_up()) {
    return power_.next();
  }
  Stamp next = std::min(heartbeat_at_, control_.next_event());
  for (std::size_t n = 0; n < kDrivePdos; ++n) {
    next = std::min(next, next_transmit(n));
  }
  return outbox_.empty() ? next : std::min(next, outbox_.front().due);
}

void EmulatedDrive::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    step(std::max(event, now_));
  }
  now_ = std::max(now_, now);
  axis_.forget(now - kMemory);
}

void EmulatedDrive::step(Stamp now) {
  now_ = now;
  if (!power_.is_up()) {
    power_.go_up();
    boot(now);
  }
  if (control_.next_event() <= now) {
    control_.step(now);
  }
  if (heartbeat_at_ <= now) {
    heartbeat_at_ = now + std::chrono::milliseconds(objects_.value(object::kHeartbeat_ms));
    if (now >= no_heartbeat_until_) {
      put(kHeartbeat + settings_.node_id, std::array{static_cast<std::uint8_t>(node_state_)}, now);
    }
  }
  settle(now);
}

// What follows from what has just happened.
void EmulatedDrive::settle(Stamp now) {
  if (const auto error = control_.take_report()) {
    remember_error(*error);
    tell_error(*error, now);
  }
  publish(now);
  release(now);
}

void EmulatedDrive::boot(Stamp now) {
  control_.start(now);
  node_state_ = NodeState::Boot;
  put(kHeartbeat + settings_.node_id, std::array<std::uint8_t, 1>{}, now);
  enter(NodeState::PreOperational, now);
}

// Nothing is left but what the encoder knows.
void EmulatedDrive::reset(Stamp now) {
  control_.cut(now);
  if (settings_.memory == DriveMemory::Incremental) {
    axis_.set_position(now, 0.0);
  }
  objects_ = defaults_;
  errors_.clear();
  reset_communication(now);
}

void EmulatedDrive::reset_communication(Stamp /*now*/) {
  objects_.restore(defaults_, 0x1000, 0x1FFF);
  outbox_.clear();
  sdo_.reset();
  heartbeat_at_ = hal::kNever;
  transmits_ = {};
  held_ = {};
  node_state_ = NodeState::Boot;
}

void EmulatedDrive::enter(NodeState state, Stamp now) {
  if (state == node_state_) {
    return;
  }
  node_state_ = state;
  held_ = {};
  for (std::size_t n = 0; n < kDrivePdos; ++n) {
    transmits_[n] = {};
    arm_timer(n, now);
  }
}

void EmulatedDrive::obey_nmt(const hal::CanFrame& frame, Stamp now) {
  if (frame.size < 2 || (frame.data[1] != 0 && frame.data[1] != settings_.node_id)) {
    return;
  }
  switch (frame.data[0]) {
    case 0x01:
      return enter(NodeState::Operational, now);
    case 0x02:
      return enter(NodeState::Stopped, now);
    case 0x80:
      return enter(NodeState::PreOperational, now);
    case 0x81:
      reset(now);
      return power_.cut(now);
    case 0x82:
      reset_communication(now);
      put(kHeartbeat + settings_.node_id, std::array<std::uint8_t, 1>{}, now);
      return enter(NodeState::PreOperational, now);
    default:
      ++refused_;
  }
}

void EmulatedDrive::receive(const hal::CanFrame& frame, Stamp at) {
  advance(at);
  if (!power_.is_up() || frame.extended) {
    return;
  }
  if (frame.id == 0) {
    obey_nmt(frame, at);
  } else if (frame.id == kSdoRequest + settings_.node_id) {
    serve(frame, at);
  } else if (node_state_ == NodeState::Operational) {
    if (frame.id == static_cast<std::uint32_t>(objects_.value(object::kSyncId))) {
      take_sync(at);
    } else if (!take_pdo(frame, at)) {
      return;
    }
  }
  if (power_.is_up()) {
    settle(at);
  }
}

void EmulatedDrive::serve(const hal::CanFrame& frame, Stamp now) {
  if (node_state_ == NodeState::Stopped || frame.size != 8) {
    refused_ += frame.size == 8 ? 0U : 1U;
    return;
  }
  if (sdo_silences_ > 0) {
    --sdo_silences_;
    return;
  }
  std::optional<SdoBytes> reply;
  if (sdo_aborts_ > 0) {
    --sdo_aborts_;
    reply = sdo_.abort(frame.data, SdoAbort::General);
  } else {
    reply = sdo_.answer(frame.data);
  }
  if (reply) {
    last_reply_ = std::max(last_reply_, now + sdo_latency_.draw());
    put(kSdoReply + settings_.node_id, *reply, last_reply_);
  }
}

void EmulatedDrive::tell_error(const DriveError& error, Stamp now) {
  const std::int64_t id = objects_.value(object::kEmergencyId);
  if (node_state_ == NodeState::Stopped || (id & 0x8000'0000) != 0) {
    return;
  }
  std::vector<std::uint8_t> bytes;
  append_number(bytes, error.code, 2);
  bytes.push_back(error.error_register);
  bytes.resize(8);
  put(static_cast<std::uint32_t>(id & 0x7FF), bytes, now);
}

void EmulatedDrive::put(std::uint32_t id, std::span<const std::uint8_t> bytes, Stamp due) {
  hal::CanFrame frame{.id = id, .extended = false, .size = static_cast<std::uint8_t>(bytes.size())};
  std::ranges::copy(bytes, frame.data.begin());
  const auto later =
      std::ranges::find_if(outbox_, [due](const Outgoing& waiting) { return waiting.due > due; });
  outbox_.insert(later, {due, frame});
}

void EmulatedDrive::release(Stamp now) {
  while (!outbox_.empty() && outbox_.front().due <= now) {
    if (outbox_.front().due >= silent_until_) {
      sink_.send(outbox_.front().frame, outbox_.front().due);
    }
    outbox_.pop_front();
  }
}

bool EmulatedDrive::inject(const Fault& fault) {
  const Stamp end = fault.at + fault.duration;
  advance(fault.at);
  switch (fault.kind) {
    case FaultKind::PowerCycle:
      reset(fault.at);
      power_.cut(end);
      return true;
    case FaultKind::NodeReset:
      reset(fault.at);
      power_.cut(fault.at);
      return true;
    case FaultKind::Silence:
      silent_until_ = std::max(silent_until_, end);
      return true;
    case FaultKind::HeartbeatLost:
      no_heartbeat_until_ = std::max(no_heartbeat_until_, end);
      return true;
    case FaultKind::SdoAbort:
      ++sdo_aborts_;
      return true;
    case FaultKind::SdoSilence:
      ++sdo_silences_;
      return true;
    case FaultKind::Emergency:
      control_.fail({settings_.emergency_code, 0x03}, fault.at, end);
      break;
    case FaultKind::MissedSteps:
      control_.jam(fault.at);
      break;
    default:
      return false;
  }
  settle(fault.at);
  return true;
}

}  // namespace slamsensor::tools
