#include "tools/emulator/canopen/emulated_drive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
  if (const auto reply = sdo_.answer(frame.data)) {
    last_reply_ = std::max(last_reply_, now + sdo_latency_.draw());
    put(kSdoReply + settings_.node_id, *reply, last_reply_);
  }
}

void EmulatedDrive::tell_error(const DriveError& error, Stamp now) {
  const std::int64_t id = objects_.value(object::kEmergencyId);
  if (node_state_ == NodeState::Stopped || (id & 0x8000'0000) != 0) {
    return;
  }
  put(static_cast<std::uint32_t>(id & 0x7FF), emergency_bytes(error.code, error.error_register), now);
}

void EmulatedDrive::put(std::uint32_t id, std::span<const std::uint8_t> bytes, Stamp due) {
  const auto later =
      std::ranges::find_if(outbox_, [due](const Outgoing& waiting) { return waiting.due > due; });
  outbox_.insert(later, {due, node_frame(id, bytes)});
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
    case FaultKind::Emergency:
      control_.fail({settings_.emergency_code, 0x03}, fault.at, end);
      break;
    case FaultKind::MissedSteps:
      control_.jam(fault.at);
      break;
    default:
      return sdo_.order(fault.kind);
  }
  settle(fault.at);
  return true;
}

// What the objects of an EmulatedDrive mean, and its PDOs.

namespace {

constexpr std::uint16_t kHistory = 0x1003;
constexpr DriveError kPdoTooShort{0x8210, 0x11};

bool is_by_sync(std::uint8_t type) noexcept {
  return type <= 240;
}

}  // namespace

std::int64_t EmulatedDrive::live_value(ObjectKey key, Stamp at) const {
  switch (key.index) {
    case object::kErrorRegister.index:
      return control_.error().error_register;
    case kHistory:
      return key.sub == 0 ? static_cast<std::int64_t>(errors_.size()) : errors_.at(key.sub - 1U);
    case object::kErrorCode.index:
      return control_.error().code;
    case object::kStatusword.index:
      return control_.statusword(at);
    case object::kModeDisplay.index:
      return control_.mode();
    case object::kPosition.index:
      return std::llround(axis_.position(at));
    case object::kVelocity.index:
      return std::llround(axis_.speed(at));
    default:
      return objects_.value(key);
  }
}

SdoAbort EmulatedDrive::read_object(ObjectKey key, std::vector<std::uint8_t>& bytes) {
  const CanObject* const object = objects_.find(key);
  if (object == nullptr) {
    return objects_.missing(key);
  }
  if (object->access == ObjectAccess::WriteOnly) {
    return SdoAbort::WriteOnly;
  }
  if (key.index == kHistory && key.sub > errors_.size()) {
    return SdoAbort::NoData;
  }
  if (object->type == ObjectType::Text) {
    bytes.assign(object->text.begin(), object->text.end());
  } else {
    append_number(bytes, live_value(key, now_), width_of(object->type));
  }
  return SdoAbort::None;
}

SdoAbort EmulatedDrive::check_meaning(ObjectKey key, std::int64_t value) const {
  if (is_pdo_object(key.index)) {
    return check_pdo_write(objects_, key, value);
  }
  const std::int64_t lower = objects_.value(object::kLowerLimit);
  const std::int64_t upper = objects_.value(object::kUpperLimit);
  if (key == object::kLowerLimit || key == object::kUpperLimit) {
    const bool is_crossed = key == object::kLowerLimit ? value > upper : value < lower;
    return is_crossed ? SdoAbort::MaxBelowMin : SdoAbort::None;
  }
  if (key == object::kMode) {
    return value == 0 || value == 1 || value == 3 || value == 6 ? SdoAbort::None : SdoAbort::ValueRange;
  }
  if (key == object::kHomingMethod) {
    constexpr std::array<std::int64_t, 5> kKnown = {0, 17, 18, 35, 37};
    return std::ranges::find(kKnown, value) != kKnown.end() ? SdoAbort::None : SdoAbort::ValueRange;
  }
  if (key.index == kHistory) {
    return value == 0 ? SdoAbort::None : SdoAbort::ValueRange;
  }
  return SdoAbort::None;
}

SdoAbort EmulatedDrive::write_object(ObjectKey key, std::span<const std::uint8_t> bytes) {
  if (const SdoAbort code = objects_.check_write(key, bytes); code != SdoAbort::None) {
    return code;
  }
  const std::int64_t value = number_from(objects_.find(key)->type, bytes);
  if (const SdoAbort code = check_meaning(key, value); code != SdoAbort::None) {
    return code;
  }
  objects_.set(key, value);
  apply(key, value, now_);
  return SdoAbort::None;
}

void EmulatedDrive::apply(ObjectKey key, std::int64_t value, Stamp now) {
  if (key == object::kControlword) {
    control_.set_controlword(static_cast<std::uint16_t>(value), now);
  } else if (key == object::kMode) {
    control_.set_mode(static_cast<std::int8_t>(value), now);
  } else if (key == object::kTargetVelocity) {
    control_.set_target_velocity(now);
  } else if (key == object::kHeartbeat_ms) {
    heartbeat_at_ = value == 0 ? hal::kNever : now;
  } else if (key.index == kHistory) {
    errors_.clear();
  } else if (key.index >= 0x1800 && key.index < 0x1800 + kDrivePdos) {
    arm_timer(key.index - 0x1800U, now);
  }
}

void EmulatedDrive::remember_error(const DriveError& error) {
  if (error.code == 0) {
    return;
  }
  errors_.push_front(error.code);
  if (errors_.size() > kErrorHistory) {
    errors_.pop_back();
  }
}

DrivePdo EmulatedDrive::transmit_pdo(std::size_t n) const {
  return {objects_, static_cast<std::uint16_t>(0x1800 + n)};
}

DrivePdo EmulatedDrive::receive_pdo(std::size_t n) const {
  return {objects_, static_cast<std::uint16_t>(0x1400 + n)};
}

void EmulatedDrive::take_sync(Stamp now) {
  for (std::size_t n = 0; n < kDrivePdos; ++n) {
    const DrivePdo pdo = transmit_pdo(n);
    const std::uint8_t type = pdo.type();
    if (!pdo.is_valid() || !is_by_sync(type)) {
      continue;
    }
    const bool is_due = type == 0 ? tells_change(n, now) : ++transmits_[n].syncs >= type;
    if (is_due) {
      transmit(n, now + settings_.sync_latch, now);
    }
  }
  for (std::size_t n = 0; n < kDrivePdos; ++n) {
    const std::vector<std::uint8_t> bytes = std::exchange(held_[n], {});
    if (!bytes.empty()) {
      apply_pdo(receive_pdo(n), bytes, now);
    }
  }
}

bool EmulatedDrive::take_pdo(const hal::CanFrame& frame, Stamp now) {
  for (std::size_t n = 0; n < kDrivePdos; ++n) {
    const DrivePdo pdo = receive_pdo(n);
    if (!pdo.is_valid() || pdo.id() != frame.id) {
      continue;
    }
    std::size_t size = 0;
    for (const PdoEntry& entry : pdo.entries()) {
      size += entry.width;
    }
    if (frame.bytes().size() < size) {
      ++refused_;
      remember_error(kPdoTooShort);
      tell_error(kPdoTooShort, now);
    } else if (is_by_sync(pdo.type())) {
      held_[n].assign(frame.bytes().begin(), frame.bytes().end());
    } else {
      apply_pdo(pdo, frame.bytes(), now);
    }
    return true;
  }
  return false;
}

// All values are there before the control word acts.
void EmulatedDrive::apply_pdo(const DrivePdo& pdo, std::span<const std::uint8_t> bytes, Stamp now) {
  now_ = now;
  std::span<const std::uint8_t> word;
  for (const PdoEntry& entry : pdo.entries()) {
    const auto part = bytes.first(entry.width);
    bytes = bytes.subspan(entry.width);
    if (entry.key == object::kControlword) {
      word = part;
    } else if (write_object(entry.key, part) != SdoAbort::None) {
      ++refused_;
    }
  }
  if (!word.empty()) {
    static_cast<void>(write_object(object::kControlword, word));
  }
}

bool EmulatedDrive::tells_change(std::size_t n, Stamp at) const {
  const std::vector<PdoEntry> entries = transmit_pdo(n).entries();
  const bool has_word =
      std::ranges::any_of(entries, [](const PdoEntry& e) { return e.key == object::kStatusword; });
  return transmits_[n].sent_word < 0 || (has_word && control_.statusword(at) != transmits_[n].sent_word);
}

void EmulatedDrive::arm_timer(std::size_t n, Stamp now) {
  const DrivePdo pdo = transmit_pdo(n);
  const Stamp period = pdo.event_time();
  const bool runs = node_state_ == NodeState::Operational && pdo.is_valid() && !is_by_sync(pdo.type());
  transmits_[n].timer_at = runs && period > Stamp::zero() ? now + period : hal::kNever;
}

// A change of the status word shows when something happens; what waits for the inhibit time comes by itself.
Stamp EmulatedDrive::next_transmit(std::size_t n) const {
  const Transmit& state = transmits_[n];
  const DrivePdo pdo = transmit_pdo(n);
  if (node_state_ != NodeState::Operational || !pdo.is_valid() || is_by_sync(pdo.type())) {
    return hal::kNever;
  }
  const Stamp due = tells_change(n, now_) ? now_ : state.timer_at;
  return due == hal::kNever ? due : std::max(due, state.may_at);
}

void EmulatedDrive::transmit(std::size_t n, Stamp latch, Stamp now) {
  const DrivePdo pdo = transmit_pdo(n);
  Transmit& state = transmits_[n];
  std::vector<std::uint8_t> bytes;
  for (const PdoEntry& entry : pdo.entries()) {
    append_number(bytes, live_value(entry.key, latch), entry.width);
  }
  state.sent_word = control_.statusword(now);
  state.syncs = 0;
  state.may_at = now + pdo.inhibit();
  arm_timer(n, now);
  last_pdo_ = std::max(last_pdo_, now + pdo_latency_.draw());
  put(pdo.id(), bytes, last_pdo_);
}

void EmulatedDrive::publish(Stamp now) {
  for (std::size_t n = 0; n < kDrivePdos; ++n) {
    if (next_transmit(n) <= now) {
      transmit(n, now, now);
    }
  }
}

namespace {

constexpr std::uint64_t kPanStream = 211;
constexpr std::uint64_t kTiltStream = 212;
constexpr std::uint64_t kChoiceStream = 213;

}  // namespace

EmulatedCanopenHead::EmulatedCanopenHead(const CanopenHeadSettings& settings, FrameSink& pan, FrameSink& tilt,
                                         std::uint64_t seed)
    : pan_(settings.pan, pan, mix_seed(seed, kPanStream)),
      tilt_(settings.tilt, tilt, mix_seed(seed, kTiltStream)),
      rng_(mix_seed(seed, kChoiceStream)) {
}

void EmulatedCanopenHead::advance(Stamp now) {
  pan_.advance(now);
  tilt_.advance(now);
}

Stamp EmulatedCanopenHead::next_event() const {
  return std::min(pan_.next_event(), tilt_.next_event());
}

bool EmulatedCanopenHead::inject(const Fault& fault) {
  if (fault.kind == FaultKind::PowerCycle || fault.kind == FaultKind::Silence) {
    const bool knows = pan_.inject(fault);
    return tilt_.inject(fault) && knows;
  }
  const bool pan_moves = pan_.is_moving(fault.at);
  const bool is_clear = pan_moves != tilt_.is_moving(fault.at);
  const bool is_pan = is_clear ? pan_moves : draw_unit(rng_) < 0.5;
  return (is_pan ? pan_ : tilt_).inject(fault);
}

HeadAngles EmulatedCanopenHead::angles_at(Stamp at) const {
  return {pan_.angle_rad(at), tilt_.angle_rad(at)};
}

}  // namespace slamsensor::tools
