#include "tools/emulator/canopen/emulated_inclinometer.hpp"

#include "core/config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace slamsensor::tools {
namespace {

constexpr ObjectKey kResolution{0x6000, 0};
constexpr ObjectKey kLong16{0x6010, 0};
constexpr ObjectKey kLateral16{0x6020, 0};
constexpr ObjectKey kLong32{0x6110, 0};
constexpr ObjectKey kLateral32{0x6120, 0};

constexpr std::uint32_t kEmergency = 0x080;
constexpr std::uint32_t kTransmitPdo = 0x180;
constexpr std::uint32_t kSdoReply = 0x580;
constexpr std::uint32_t kSdoRequest = 0x600;
constexpr std::uint32_t kHeartbeat = 0x700;

using core::kDegree;
constexpr double kOverRange_rad = 200.0 * kDegree;
constexpr std::uint16_t kOverRangeCode = 0x5000;
constexpr Stamp kAnswer = std::chrono::microseconds(500);

ObjectDictionary objects_of(const InclinometerSettings& settings) {
  using enum ObjectType;
  ObjectDictionary objects;
  objects.add({0x1000, 0}, {U32, ObjectAccess::ReadOnly, 0x0003'019A});
  objects.add({0x1001, 0}, {U8});
  objects.add({0x1008, 0}, {.type = Text, .text = "emulated inclinometer"});
  objects.add({0x1017, 0}, {U16, ObjectAccess::ReadWrite});
  objects.add(kResolution, {U16, ObjectAccess::ReadWrite, settings.resolution});
  objects.add(kLong16, {I16});
  objects.add(kLateral16, {I16});
  if (settings.has_32_bits) {
    objects.add(kLong32, {I32});
    objects.add(kLateral32, {I32});
  }
  return objects;
}

}  // namespace

EmulatedInclinometer::EmulatedInclinometer(const InclinometerSettings& settings, FrameSink& sink)
    : settings_(settings),
      sink_(sink),
      objects_(objects_of(settings)),
      sdo_(*this),
      power_(settings.begin, settings.boot_time) {
  measure();
}

void EmulatedInclinometer::lean(double roll_rad, double pitch_rad, Stamp at) {
  advance(at);
  // How far the ends of the axes are below and above the horizontal.
  x_rad_ = pitch_rad;
  y_rad_ = std::asin(std::cos(pitch_rad) * std::sin(roll_rad));
  const bool was_over = is_over_range_;
  measure();
  if (is_over_range_ != was_over && power_.is_up()) {
    tell_emergency(is_over_range_ ? kOverRangeCode : 0, is_over_range_ ? 0x81 : 0, at);
  }
}

void EmulatedInclinometer::measure() {
  is_over_range_ = std::abs(x_rad_) > settings_.range_rad || std::abs(y_rad_) > settings_.range_rad;
  const double unit_rad = 0.001 * kDegree * static_cast<double>(objects_.value(kResolution));
  for (const auto& [key16, key32, angle_rad] :
       {std::tuple(kLong16, kLong32, x_rad_), std::tuple(kLateral16, kLateral32, y_rad_)}) {
    const bool is_over = std::abs(angle_rad) > settings_.range_rad;
    const std::int64_t reported = std::llround((is_over ? kOverRange_rad : angle_rad) / unit_rad);
    objects_.set(key16, std::clamp<std::int64_t>(reported, INT16_MIN, INT16_MAX));
    if (settings_.has_32_bits) {
      objects_.set(key32, reported);
    }
  }
}

Stamp EmulatedInclinometer::next_event() const {
  return power_.is_up() ? pdo_at_ : power_.next();
}

void EmulatedInclinometer::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    if (!power_.is_up()) {
      power_.go_up();
      boot(event);
      continue;
    }
    std::vector<std::uint8_t> bytes;
    append_number(bytes, objects_.value(kLong16), 2);
    append_number(bytes, objects_.value(kLateral16), 2);
    send(kTransmitPdo + settings_.node_id, bytes, event);
    pdo_at_ = event + settings_.period;
  }
}

void EmulatedInclinometer::boot(Stamp now) {
  objects_ = objects_of(settings_);
  sdo_.reset();
  is_operational_ = false;
  pdo_at_ = hal::kNever;
  measure();
  send(kHeartbeat + settings_.node_id, std::array<std::uint8_t, 1>{}, now);
}

void EmulatedInclinometer::receive(const hal::CanFrame& frame, Stamp at) {
  advance(at);
  if (!power_.is_up() || frame.extended) {
    return;
  }
  if (frame.id == 0) {
    obey_nmt(frame, at);
  } else if (frame.id == kSdoRequest + settings_.node_id && frame.size == 8) {
    if (const auto reply = sdo_.answer(frame.data)) {
      send(kSdoReply + settings_.node_id, *reply, at + kAnswer);
    }
  }
}

void EmulatedInclinometer::obey_nmt(const hal::CanFrame& frame, Stamp now) {
  if (frame.size < 2 || (frame.data[1] != 0 && frame.data[1] != settings_.node_id)) {
    return;
  }
  switch (frame.data[0]) {
    case 0x01:
      is_operational_ = true;
      pdo_at_ = now + settings_.period;
      return;
    case 0x02:
    case 0x80:
      is_operational_ = false;
      pdo_at_ = hal::kNever;
      return;
    case 0x81:
    case 0x82:
      return power_.cut(now);
    default:
      return;
  }
}

SdoAbort EmulatedInclinometer::read_object(ObjectKey key, std::vector<std::uint8_t>& bytes) {
  const CanObject* const object = objects_.find(key);
  if (object == nullptr) {
    return objects_.missing(key);
  }
  if (object->type == ObjectType::Text) {
    bytes.assign(object->text.begin(), object->text.end());
  } else {
    append_number(bytes, object->value, width_of(object->type));
  }
  return SdoAbort::None;
}

SdoAbort EmulatedInclinometer::write_object(ObjectKey key, std::span<const std::uint8_t> bytes) {
  const SdoAbort refusal = objects_.check_write(key, bytes);
  if (refusal != SdoAbort::None) {
    return refusal;
  }
  const std::int64_t value = number_from(objects_.find(key)->type, bytes);
  if (key == kResolution && value != 1 && value != 10 && value != 100 && value != 1000) {
    return SdoAbort::ValueRange;
  }
  objects_.set(key, value);
  measure();
  return SdoAbort::None;
}

void EmulatedInclinometer::tell_emergency(std::uint16_t code, std::uint8_t error_register, Stamp now) {
  objects_.set({0x1001, 0}, error_register);
  send(kEmergency + settings_.node_id, emergency_bytes(code, error_register), now);
}

void EmulatedInclinometer::send(std::uint32_t id, std::span<const std::uint8_t> bytes, Stamp at) {
  if (at >= silent_until_) {
    sink_.send(node_frame(id, bytes), at);
  }
}

bool EmulatedInclinometer::inject(const Fault& fault) {
  advance(fault.at);
  const Stamp end = fault.at + fault.duration;
  switch (fault.kind) {
    case FaultKind::PowerCycle:
      power_.cut(end);
      return true;
    case FaultKind::NodeReset:
      power_.cut(fault.at);
      return true;
    case FaultKind::Silence:
      silent_until_ = std::max(silent_until_, end);
      return true;
    case FaultKind::Emergency:
      tell_emergency(kOverRangeCode, 0x81, fault.at);
      return true;
    default:
      return sdo_.order(fault.kind);
  }
}

}  // namespace slamsensor::tools
