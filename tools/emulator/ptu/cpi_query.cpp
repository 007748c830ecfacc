#include "tools/emulator/ptu/cpi_query.hpp"

#include <cmath>

namespace slamsensor::tools {
namespace {

// Of pairs, pan's is odd and tilt's the next; only pan's stands here.
enum Opcode : std::uint8_t {
  kPosition = 145,
  kDesiredPosition = 147,
  kMinPosition = 149,
  kMaxPosition = 151,
  kSpeed = 153,
  kDesiredSpeed = 155,
  kBaseSpeed = 157,
  kUpperSpeed = 159,
  kLowerSpeed = 161,
  kAcceleration = 163,
  kResolution = 165,
  kLastOfPairs = 166,
  kLimits = 171,
  kUnitId = 179,
  kEcho = 180,
  kPanHoldPower = 186,
  kTiltHoldPower = 187,
  kPanMovePower = 188,
  kTiltMovePower = 189,
  kFeedback = 190,
  kVersion = 196,
  kControl = 203,
  kMotion = 223,
};

// The low `bytes` bytes of `value`, the highest first.
std::string big_endian(long value, int bytes) {
  std::string text;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    text += static_cast<char>((static_cast<unsigned long>(value) >> static_cast<unsigned>(shift)) & 0xFFU);
  }
  return text;
}

std::string word(long value) {
  return big_endian(value, 2);
}

std::string byte(long value) {
  return big_endian(value, 1);
}

std::string byte(PtuPower power) {
  return byte(static_cast<long>(power));
}

std::string of_pair(const PtuUnit& unit, std::uint8_t opcode, Stamp now) {
  const PtuAxisId id = opcode % 2 == 1 ? PtuAxisId::Pan : PtuAxisId::Tilt;
  const PtuAxis& axis = unit.head.axis(id);
  const PtuAxisConfig& own = unit.head.config.axes[index_of(id)];
  switch (opcode - (id == PtuAxisId::Tilt ? 1 : 0)) {
    case kPosition:
      return word(axis.position(now - unit.settings.position_latency));
    case kDesiredPosition:
      return word(axis.target());
    case kMinPosition:
      return word(axis.min());
    case kMaxPosition:
      return word(axis.max());
    case kSpeed:
      return word(unit.head.current_speed(id, now));
    case kDesiredSpeed:
      return word(unit.head.desired_speed(id));
    case kBaseSpeed:
      return word(own.base_speed);
    case kUpperSpeed:
      return word(own.upper_speed);
    case kLowerSpeed:
      return word(own.lower_speed);
    case kAcceleration:
      return big_endian(own.acceleration + unit.settings.acceleration_read_back, 4);
    default:
      return big_endian(std::lround(60.0 * axis.resolution_arcsec()), 4);
  }
}

std::string motion(const PtuHead& head, Stamp seen) {
  constexpr auto kPan = PtuAxisId::Pan;
  constexpr auto kTilt = PtuAxisId::Tilt;
  return word(head.axis(kPan).position(seen)) + word(head.axis(kTilt).position(seen)) +
         word(head.current_speed(kPan, seen)) + word(head.current_speed(kTilt, seen));
}

}  // namespace

std::optional<std::string> query_cpi(const PtuUnit& unit, std::uint8_t opcode, Stamp now) {
  const PtuConfig& config = unit.head.config;
  if (opcode >= kPosition && opcode <= kLastOfPairs) {
    return of_pair(unit, opcode, now);
  }
  switch (opcode) {
    case kLimits:
      return byte(config.limits == PtuLimits::Disabled ? 0 : 1);
    case kUnitId:
      return byte(config.unit_id);
    case kEcho:
      return byte(config.echo == PtuEcho::On ? 1 : 0);
    case kPanHoldPower:
      return byte(config.axes[0].hold_power);
    case kTiltHoldPower:
      return byte(config.axes[1].hold_power);
    case kPanMovePower:
      return byte(config.axes[0].move_power);
    case kTiltMovePower:
      return byte(config.axes[1].move_power);
    case kFeedback:
      return byte(config.feedback == PtuFeedback::Verbose ? 1 : 0);
    case kVersion:
      return unit.settings.wording.version + "\n";
    case kControl:
      return byte(static_cast<long>(config.control));
    case kMotion:
      return unit.settings.model.series == PtuSeries::E
                 ? std::optional(motion(unit.head, now - unit.settings.position_latency))
                 : std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace slamsensor::tools
