// What the objects of an EmulatedDrive mean, and its PDOs.
#include "tools/emulator/canopen/emulated_drive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::uint16_t kHistory = 0x1003;
constexpr DriveError kPdoTooShort{0x8210, 0x11};

bool is_by_sync(std::uint8_t type) noexcept {
  return type <= 240;
}

}  // namespace

std::size_t EmulatedDrive::object_width(ObjectKey key) const {
  const CanObject* const object = objects_.find(key);
  return object == nullptr ? 0 : width_of(object->type);
}

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
    return check_pdo_write(objects_, settings_, key, value);
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
    constexpr std::array<std::int64_t, 9> kKnown = {0, 1, 2, 17, 18, 33, 34, 35, 37};
    return std::ranges::find(kKnown, value) != kKnown.end() ? SdoAbort::None : SdoAbort::ValueRange;
  }
  if (key.index == kHistory) {
    return value == 0 ? SdoAbort::None : SdoAbort::ValueRange;
  }
  const bool refuses = settings_.limit_rule == DriveLimitRule::Refuse && (lower != 0 || upper != 0);
  if (key == object::kTarget && refuses && (value < lower || value > upper)) {
    return value < lower ? SdoAbort::ValueTooLow : SdoAbort::ValueTooHigh;
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
  return transmits_[n].told < 0 || (has_word && control_.statusword(at) != transmits_[n].told);
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
  state.told = control_.statusword(now);
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

}  // namespace slamsensor::tools
