#include "tools/emulator/canopen/drive_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace slamsensor::tools {

double DriveSettings::counts_per_rad() const noexcept {
  return direction * static_cast<double>(encoder_counts) * static_cast<double>(gear_turns) /
         (2.0 * std::numbers::pi);
}

CanopenHeadSettings canopen_head_settings() {
  CanopenHeadSettings settings;
  settings.tilt.node_id = 2;
  settings.tilt.serial_number = 2;
  settings.tilt.lower_limit = -53'476;
  settings.tilt.upper_limit = 35'271;
  return settings;
}

namespace {

// Adds a leg from `from` to `to` (amounts of speed) in `direction`; returns the way on it.
double add_ramp(MotionPlan& plan, double from, double to, double direction, double rate) {
  if (from == to) {
    return 0.0;
  }
  const double duration_s = std::abs(to - from) / rate;
  plan.legs.push_back({duration_s, direction * from, direction * std::copysign(rate, to - from)});
  return 0.5 * (from + to) * duration_s;
}

double duration_of(const MotionPlan& plan) {
  double sum_s = 0.0;
  for (const MotionLeg& leg : plan.legs) {
    sum_s += leg.duration_s;
  }
  return sum_s;
}

struct Approach {
  DriveProfile profile;
  double cruise_s = 0.0;  // when its highest speed is reached
};

// From `speed` in `direction`, slow enough to stop in time, to rest `way` further.
Approach approach(double speed, double way, double direction, const DriveRates& rates) {
  Approach result;
  MotionPlan& plan = result.profile.plan;
  const double up = rates.acceleration;
  const double down = rates.deceleration;
  double peak = std::sqrt((2.0 * up * down * way + down * speed * speed) / (up + down));
  peak = std::min(peak, rates.speed);
  const double first = add_ramp(plan, speed, peak, direction, peak > speed ? up : down);
  result.cruise_s = duration_of(plan);
  const double cruise = way - first - peak * peak / (2.0 * down);
  if (cruise > 0.0 && peak > 0.0) {
    plan.legs.push_back({cruise / peak, direction * peak, 0.0});
  }
  add_ramp(plan, peak, 0.0, direction, down);
  result.profile.settled_s = duration_of(plan);
  return result;
}

// As plan_profile(); `cruise_s` is of the motion after a turn.
Approach go(StepperState state, double target, const DriveRates& rates) {
  const double ahead = target - state.position;
  const double brake = state.speed * state.speed / (2.0 * rates.deceleration);
  DriveProfile before;
  if (state.speed != 0.0 && (state.speed * ahead <= 0.0 || brake > std::abs(ahead) + 1e-9)) {
    before = plan_rest(state, rates.deceleration);
    state = {before.plan.end, 0.0};
  }
  const double way = target - state.position;
  Approach last;
  if (way != 0.0 && rates.speed > 0.0) {
    last = approach(std::abs(state.speed), std::abs(way), way < 0.0 ? -1.0 : 1.0, rates);
    last.profile.plan.end = target;
  } else {
    last.profile = plan_rest(state, rates.deceleration);
  }
  last.cruise_s += before.settled_s;
  last.profile = then(std::move(before), last.profile);
  return last;
}

}  // namespace

DriveProfile plan_profile(StepperState state, double target, const DriveRates& rates) {
  return go(state, target, rates).profile;
}

DriveProfile plan_run(const StepperState& state, double bound, const DriveRates& rates) {
  Approach run = go(state, bound, rates);
  run.profile.settled_s = run.cruise_s;
  return run.profile;
}

DriveProfile plan_rest(const StepperState& state, double deceleration) {
  DriveProfile profile;
  const double direction = state.speed < 0.0 ? -1.0 : 1.0;
  const double way = add_ramp(profile.plan, std::abs(state.speed), 0.0, direction, deceleration);
  profile.plan.end = state.position + direction * way;
  profile.settled_s = duration_of(profile.plan);
  return profile;
}

DriveProfile then(DriveProfile first, const DriveProfile& second) {
  const double begin_s = duration_of(first.plan);
  first.plan.legs.insert(first.plan.legs.end(), second.plan.legs.begin(), second.plan.legs.end());
  first.plan.end = second.plan.end;
  first.settled_s = begin_s + second.settled_s;
  return first;
}

namespace {

// CiA 402, homing methods.
constexpr long kLowerSwitch = 17;
constexpr long kUpperSwitch = 18;
constexpr long kHere = 37;
constexpr long kHereBefore = 35;  // its number in older editions

}  // namespace

DriveAxis::DriveAxis(const DriveSettings& settings)
    : settings_(settings), motion_(static_cast<double>(settings.start)) {
}

void DriveAxis::follow(Stamp at, const DriveProfile& profile) {
  motion_.follow(at, profile.plan);
  settled_at_ = at + hal::from_seconds(profile.settled_s);
  const auto margin = static_cast<double>(settings_.stop_margin);
  hit_at_ = motion_.leaves(at, static_cast<double>(settings_.lower_limit) - margin,
                           static_cast<double>(settings_.upper_limit) + margin);
}

void DriveAxis::move(Stamp at, double target, const DriveRates& rates) {
  follow(at, plan_profile({position(at), speed(at)}, target, rates));
}

void DriveAxis::run(Stamp at, double bound, const DriveRates& rates) {
  follow(at, plan_run({position(at), speed(at)}, bound, rates));
}

void DriveAxis::stop(Stamp at, double deceleration) {
  follow(at, plan_rest({position(at), speed(at)}, deceleration));
}

void DriveAxis::freeze(Stamp at) {
  motion_.rest(at, position(at), motion_.slip(at));
  settled_at_ = at;
  hit_at_ = hal::kNever;
}

void DriveAxis::set_position(Stamp at, double new_position) {
  motion_.rest(at, new_position, truth(at) - new_position);
  settled_at_ = at;
  hit_at_ = hal::kNever;
}

// Beyond the switch's edge at full speed, then stopped by the ramp, or by the stop if that is nearer.
DriveProfile DriveAxis::to_switch(const StepperState& state, double edge, double direction,
                                  const HomingRates& rates) const {
  const double room = static_cast<double>(settings_.stop_margin - settings_.switch_margin) - 1.0;
  const double overshoot =
      std::min(rates.fast * rates.fast / (2.0 * rates.acceleration), std::max(room, 0.0));
  const double turn = edge + direction * overshoot;
  const double from = direction * state.position >= direction * edge ? state.position : turn;
  return plan_profile(state, from, {rates.fast, rates.acceleration, rates.acceleration});
}

bool DriveAxis::home(Stamp at, long method, const HomingRates& rates) {
  if (method == kHere || method == kHereBefore) {
    stop(at, rates.acceleration);
    return true;
  }
  if (method != kLowerSwitch && method != kUpperSwitch) {
    return false;
  }
  const double direction = method == kLowerSwitch ? -1.0 : 1.0;
  const double limit = static_cast<double>(direction < 0.0 ? settings_.lower_limit : settings_.upper_limit);
  const double edge = limit + direction * static_cast<double>(settings_.switch_margin) - motion_.slip(at);
  const DriveProfile there = to_switch({position(at), speed(at)}, edge, direction, rates);
  const DriveRates slow{rates.slow, rates.acceleration, rates.acceleration};
  follow(at, then(there, plan_profile({there.plan.end, 0.0}, edge, slow)));
  return true;
}

Stamp DriveAxis::gets_away(Stamp at, double window) const {
  const double here = truth(at);
  return motion_.leaves(at, here - window, here + window);
}

namespace {

using enum ObjectType;
using enum ObjectAccess;

constexpr std::int64_t kAsDrive = 0x0002'0192;  // CiA 402 servo drive
constexpr std::int64_t kModes = 0x25;           // profile position, profile velocity, homing
constexpr std::int64_t kNoPdo = 0x8000'0000;
constexpr std::int64_t kByEvent = 255;

void add_text(ObjectDictionary& objects, std::uint16_t index, const std::string& text) {
  objects.add({index, 0}, {.type = Text, .text = text});
}

void add_array(ObjectDictionary& objects, std::uint16_t index, const CanObject& object,
               std::span<const std::int64_t> values) {
  objects.add({index, 0}, {.type = U8, .value = static_cast<std::int64_t>(values.size())});
  std::uint8_t sub = 0;
  for (const std::int64_t value : values) {
    CanObject entry = object;
    entry.value = value;
    objects.add({index, ++sub}, entry);
  }
}

void add_communication(ObjectDictionary& objects, const DriveSettings& settings) {
  objects.add({0x1000, 0}, {.value = kAsDrive});
  objects.add(object::kErrorRegister, {.type = U8, .mapping = ObjectMapping::Transmit});
  objects.add({0x1003, 0}, {.type = U8, .access = ReadWrite});
  for (std::uint8_t sub = 1; sub <= kErrorHistory; ++sub) {
    objects.add({0x1003, sub}, {});
  }
  objects.add(object::kSyncId, {.access = ReadWrite, .value = 0x80, .low = 1, .high = 0x7FF});
  add_text(objects, 0x1008, settings.device_name);
  add_text(objects, 0x100A, settings.software_version);
  objects.add(object::kEmergencyId, {.access = ReadWrite, .value = 0x80 + settings.node_id});
  objects.add(object::kHeartbeat_ms, {.type = U16, .access = ReadWrite});
  add_array(objects, 0x1018, {},
            std::array<std::int64_t, 4>{settings.vendor_id, settings.product_code, settings.revision,
                                        settings.serial_number});
}

// Of both directions: the words alone, with positions, with velocities, none.
std::vector<std::int64_t> default_map(std::uint16_t pdo, std::int64_t word, std::int64_t position,
                                      std::int64_t velocity) {
  switch (pdo) {
    case 0:
      return {word};
    case 1:
      return {word, position};
    case 2:
      return {word, velocity};
    default:
      return {};
  }
}

void add_pdo(ObjectDictionary& objects, std::uint16_t communication, std::int64_t id,
             const std::vector<std::int64_t>& map) {
  objects.add({communication, 0}, {.type = U8, .value = 5});
  objects.add({communication, 1}, {.access = ReadWrite, .value = map.empty() ? id + kNoPdo : id});
  objects.add({communication, 2}, {.type = U8, .access = ReadWrite, .value = kByEvent});
  objects.add({communication, 3}, {.type = U16, .access = ReadWrite});
  objects.add({communication, 5}, {.type = U16, .access = ReadWrite});
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  objects.add({mapping, 0},
              {.type = U8, .access = ReadWrite, .value = static_cast<std::int64_t>(map.size())});
  for (std::uint8_t i = 0; i < kPdoEntriesMax; ++i) {
    objects.add({mapping, static_cast<std::uint8_t>(i + 1)},
                {.access = ReadWrite, .value = i < map.size() ? map[i] : 0});
  }
}

void add_pdos(ObjectDictionary& objects, const DriveSettings& settings) {
  for (std::uint16_t n = 0; n < kDrivePdos; ++n) {
    const std::int64_t id = 0x100 * n + settings.node_id;
    add_pdo(objects, static_cast<std::uint16_t>(0x1400 + n), 0x200 + id,
            default_map(n, 0x6040'0010, 0x607A'0020, 0x60FF'0020));
    add_pdo(objects, static_cast<std::uint16_t>(0x1800 + n), 0x180 + id,
            default_map(n, 0x6041'0010, 0x6064'0020, 0x606C'0020));
  }
}

void add_state(ObjectDictionary& objects, const DriveSettings& settings) {
  using enum ObjectMapping;
  objects.add(object::kErrorCode, {.type = U16, .mapping = Transmit});
  objects.add(object::kControlword, {.type = U16, .access = ReadWrite, .mapping = Receive});
  objects.add(object::kStatusword, {.type = U16, .mapping = Transmit});
  objects.add(object::kQuickStopOption, {.type = I16, .access = ReadWrite, .value = 2, .low = 0, .high = 6});
  objects.add(object::kMode, {.type = I8, .access = ReadWrite, .mapping = Receive});
  objects.add(object::kModeDisplay, {.type = I8, .mapping = Transmit});
  objects.add(object::kPosition, {.type = I32, .mapping = Transmit});
  objects.add(object::kFollowingWindow, {.access = ReadWrite, .value = settings.following_window});
  objects.add(object::kVelocity, {.type = I32, .mapping = Transmit});
  objects.add({0x6502, 0}, {.value = kModes});
}

void add_motion(ObjectDictionary& objects, const DriveSettings& settings) {
  using enum ObjectMapping;
  const std::int64_t fastest = settings.max_speed;
  const CanObject speed{
      .access = ReadWrite, .value = settings.speed, .mapping = Both, .low = 1, .high = fastest};
  const CanObject ramp{.access = ReadWrite, .value = settings.acceleration, .mapping = Both, .low = 1};
  const CanObject limit{.type = I32, .access = ReadWrite};
  const CanObject fact{};
  objects.add(object::kTarget, {.type = I32, .access = ReadWrite, .value = settings.start, .mapping = Both});
  objects.add(object::kHomeOffset, {.type = I32, .access = ReadWrite, .value = settings.home_offset});
  add_array(objects, 0x607D, limit, std::array<std::int64_t, 2>{settings.lower_limit, settings.upper_limit});
  objects.add(object::kProfileSpeed, speed);
  objects.add(object::kAcceleration, ramp);
  objects.add(object::kDeceleration, ramp);
  objects.add(object::kQuickStop, {.access = ReadWrite, .value = settings.quick_stop, .low = 1});
  objects.add({0x6086, 0}, {.type = I16, .access = ReadWrite, .low = 0, .high = 0});
  add_array(objects, 0x608F, fact, std::array<std::int64_t, 2>{settings.encoder_counts, 1});
  add_array(objects, 0x6091, fact, std::array<std::int64_t, 2>{settings.gear_turns, 1});
  objects.add(object::kHomingMethod, {.type = I8, .access = ReadWrite});
  add_array(objects, 0x6099, {.access = ReadWrite, .low = 1, .high = fastest},
            std::array<std::int64_t, 2>{settings.homing_speed, (settings.homing_speed + 9) / 10});
  objects.add(object::kHomingAcceleration, {.access = ReadWrite, .value = settings.acceleration, .low = 1});
  objects.add(object::kTargetVelocity,
              {.type = I32, .access = ReadWrite, .mapping = Both, .low = -fastest, .high = fastest});
}

}  // namespace

ObjectDictionary drive_objects(const DriveSettings& settings) {
  ObjectDictionary objects;
  add_communication(objects, settings);
  add_pdos(objects, settings);
  add_state(objects, settings);
  add_motion(objects, settings);
  return objects;
}

namespace {

constexpr std::int64_t kInvalid = 0x8000'0000;
constexpr std::int64_t kExtended = 0x2000'0000;
constexpr std::int64_t kIdBits = 0x7FF;

bool is_transmit(std::uint16_t index) noexcept {
  return index >= 0x1800;
}

bool is_map(std::uint16_t index) noexcept {
  return (index & 0x0200U) != 0;
}

PdoEntry entry_of(std::int64_t word) noexcept {
  return {{static_cast<std::uint16_t>(word >> 16), static_cast<std::uint8_t>(word >> 8)},
          static_cast<std::uint8_t>((word & 0xFF) / 8)};
}

SdoAbort check_entry(const ObjectDictionary& objects, std::int64_t word, ObjectMapping way) {
  const PdoEntry entry = entry_of(word);
  const CanObject* const mapped = objects.find(entry.key);
  if (mapped == nullptr) {
    return objects.missing(entry.key);
  }
  const bool fits = mapped->mapping == way || mapped->mapping == ObjectMapping::Both;
  return fits && (word & 0xFF) == 8 * width_of(mapped->type) ? SdoAbort::None : SdoAbort::NotMappable;
}

SdoAbort check_map(const ObjectDictionary& objects, ObjectKey key, std::int64_t value) {
  const ObjectMapping way = is_transmit(key.index) ? ObjectMapping::Transmit : ObjectMapping::Receive;
  if (DrivePdo(objects, static_cast<std::uint16_t>(key.index - 0x200)).is_valid()) {
    return SdoAbort::UnsupportedAccess;
  }
  if (key.sub != 0) {
    const bool is_open = objects.value({key.index, 0}) == 0;
    return is_open ? check_entry(objects, value, way) : SdoAbort::UnsupportedAccess;
  }
  if (value > kPdoEntriesMax) {
    return SdoAbort::MappingTooLong;
  }
  int bytes = 0;
  for (std::uint8_t sub = 1; sub <= value; ++sub) {
    const std::int64_t word = objects.value({key.index, sub});
    if (check_entry(objects, word, way) != SdoAbort::None) {
      return SdoAbort::NotMappable;
    }
    bytes += entry_of(word).width;
  }
  return bytes <= 8 ? SdoAbort::None : SdoAbort::MappingTooLong;
}

SdoAbort check_id(const DrivePdo& pdo, std::int64_t value) {
  const bool changes = pdo.is_valid() && (value & kInvalid) == 0 && (value & kIdBits) != pdo.id();
  const bool has_strange_bits = (value & kExtended) != 0 || (value & 0x1FFF'F800) != 0;
  return changes || has_strange_bits ? SdoAbort::ValueRange : SdoAbort::None;
}

}  // namespace

std::uint8_t DrivePdo::type() const {
  return static_cast<std::uint8_t>(parameter(2));
}

Stamp DrivePdo::inhibit() const {
  return std::chrono::microseconds(100 * parameter(3));
}

Stamp DrivePdo::event_time() const {
  return std::chrono::milliseconds(parameter(5));
}

std::vector<PdoEntry> DrivePdo::entries() const {
  const auto map = static_cast<std::uint16_t>(communication_ + 0x200);
  std::vector<PdoEntry> entries;
  for (std::uint8_t sub = 1; sub <= objects_.value({map, 0}); ++sub) {
    entries.push_back(entry_of(objects_.value({map, sub})));
  }
  return entries;
}

bool is_pdo_object(std::uint16_t index) noexcept {
  return index >= 0x1400 && index < 0x1C00;
}

SdoAbort check_pdo_write(const ObjectDictionary& objects, ObjectKey key, std::int64_t value) {
  if (is_map(key.index)) {
    return check_map(objects, key, value);
  }
  const DrivePdo pdo(objects, key.index);
  if (key.sub == 1) {
    return check_id(pdo, value);
  }
  if (key.sub == 2) {
    return value > 240 && value < 254 ? SdoAbort::ValueRange : SdoAbort::None;
  }
  return key.sub == 3 && pdo.is_valid() ? SdoAbort::WrongState : SdoAbort::None;
}

}  // namespace slamsensor::tools
