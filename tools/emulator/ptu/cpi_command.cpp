#include "tools/emulator/ptu/cpi_command.hpp"

#include "tools/emulator/ptu/cpi_query.hpp"

namespace slamsensor::tools {
namespace {

// Of pairs, pan's is odd and tilt's the next; only pan's stands here.
enum Opcode : std::uint8_t {
  kAbsolutePosition = 129,
  kRelativePosition = 131,
  kRelativeSpeed = 133,
  kAbsoluteSpeed = 135,
  kBaseSpeed = 137,
  kUpperSpeed = 139,
  kLowerSpeed = 141,
  kSetUnitId = 143,
  kSelectUnit = 144,
  kAwait = 167,
  kHalt = 168,
  kHaltPan = 169,
  kHaltTilt = 170,
  kLimitsOn = 172,
  kLimitsOff = 173,
  kImmediate = 174,
  kSlaved = 175,
  kReset = 176,
  kResetOnPowerUp = 177,
  kNoResetOnPowerUp = 178,
  kEchoOn = 181,
  kEchoOff = 182,
  kSave = 183,
  kRestore = 184,
  kFactory = 185,
  kVerbose = 191,
  kTerse = 192,
  kFirstPower = 197,
  kLastPower = 200,
  kPanAcceleration = 201,
  kTiltAcceleration = 202,
  kIndependent = 204,
  kVelocity = 205,
  kResetPan = 220,
  kResetTilt = 221,
  kSetMotion = 222,
  kEnvironment = 224,
  kSetVelocities = 234,
};

struct CpiCall {
  PtuUnit& unit;
  std::span<const std::uint8_t> bytes;
  Stamp now;

  [[nodiscard]] std::uint8_t opcode() const { return bytes[0]; }
  [[nodiscard]] PtuHead& head() const { return unit.head; }
  [[nodiscard]] PtuAxisId axis() const { return opcode() % 2 == 1 ? PtuAxisId::Pan : PtuAxisId::Tilt; }
  [[nodiscard]] long word(std::size_t number) const {
    return (long{bytes[1 + 2 * number]} << 8U) | long{bytes[2 + 2 * number]};
  }
  [[nodiscard]] long signed_word(std::size_t number) const {
    const long value = word(number);
    return value >= 0x8000 ? value - 0x10000 : value;
  }
};

PtuAnswer status(PtuStatus code) {
  return {.bytes = std::string(1, static_cast<char>(code)), .form = PtuForm::Binary};
}

PtuAnswer judged(const PtuVerdict& verdict) {
  return status(verdict.status);
}

PtuAnswer waiting(PtuAnswer answer, PtuAnswer::Wait wait) {
  answer.wait = wait;
  return answer;
}

PtuAnswer table(const PtuVerdict& verdict, Stamp time) {
  PtuAnswer answer = judged(verdict);
  if (verdict.status == PtuStatus::Ok) {
    answer.wait = PtuAnswer::Wait::Time;
    answer.time = time;
  }
  return answer;
}

PtuAnswer set_unit_id(const CpiCall& call) {
  constexpr long kUnitMax = 127;
  if (call.word(0) > kUnitMax) {
    return status(PtuStatus::IllegalUnitId);
  }
  call.unit.selected_unit = static_cast<int>(call.word(0));
  if (call.opcode() == kSetUnitId) {
    call.head().config.unit_id = static_cast<std::uint8_t>(call.word(0));
  }
  return status(PtuStatus::Ok);
}

PtuAnswer set_word(const CpiCall& call) {
  PtuHead& head = call.head();
  const PtuAxisId id = call.axis();
  const PtuTableTimes& times = call.unit.settings.table_times;
  switch (call.opcode() - (id == PtuAxisId::Tilt ? 1 : 0)) {
    case kAbsolutePosition:
      return judged(head.set_position(id, call.signed_word(0), call.now));
    case kRelativePosition:
      return judged(head.set_position(id, head.axis(id).position(call.now) + call.signed_word(0), call.now));
    case kRelativeSpeed:
      return judged(head.set_speed(id, head.current_speed(id, call.now) + call.signed_word(0), call.now));
    case kAbsoluteSpeed:
      return judged(head.set_speed(
          id, head.config.control == PtuControl::Velocity ? call.signed_word(0) : call.word(0), call.now));
    case kBaseSpeed:
      return table(head.set_base_speed(id, call.word(0), call.now), times.base);
    case kUpperSpeed:
      return table(head.set_upper_speed(id, call.word(0), call.now), times.upper);
    case kLowerSpeed:
      return table(head.set_lower_speed(id, call.word(0), call.now), times.lower);
    default:
      return set_unit_id(call);
  }
}

PtuAnswer set_power(const CpiCall& call) {
  PtuAxisConfig& own = call.head().parameters(call.axis());
  const std::uint8_t mode = call.bytes[1];
  const bool is_hold = call.opcode() < kFirstPower + 2;
  const auto banned = is_hold ? PtuPower::High : PtuPower::Off;
  if (mode < 1 || mode > 4 || mode == static_cast<std::uint8_t>(banned)) {
    return status(PtuStatus::IllegalPower);
  }
  (is_hold ? own.hold_power : own.move_power) = static_cast<PtuPower>(mode);
  return status(PtuStatus::Ok);
}

PtuAnswer set_acceleration(const CpiCall& call) {
  const long value = (call.word(0) << 16U) | call.word(1);
  return table(call.head().set_acceleration(call.axis(), value, call.now),
               call.unit.settings.table_times.acceleration);
}

PtuAnswer halt(const CpiCall& call) {
  if (call.opcode() != kHaltTilt) {
    call.head().halt(PtuAxisId::Pan, call.now);
  }
  if (call.opcode() != kHaltPan) {
    call.head().halt(PtuAxisId::Tilt, call.now);
  }
  return status(PtuStatus::Ok);
}

// Both velocities and the low byte of the sum of their four bytes.
PtuAnswer set_velocities(const CpiCall& call) {
  const int sum = call.bytes[1] + call.bytes[2] + call.bytes[3] + call.bytes[4];
  if (static_cast<std::uint8_t>(sum) != call.bytes[5]) {
    return status(PtuStatus::Checksum);
  }
  PtuHead& head = call.head();
  for (const PtuAxisId id : {PtuAxisId::Pan, PtuAxisId::Tilt}) {
    const PtuVerdict verdict = head.check_speed(id, call.signed_word(index_of(id)));
    if (verdict.status != PtuStatus::Ok) {
      return judged(verdict);
    }
  }
  const PtuVerdict pan = head.set_speed(PtuAxisId::Pan, call.signed_word(0), call.now);
  const PtuVerdict tilt = head.set_speed(PtuAxisId::Tilt, call.signed_word(1), call.now);
  return judged(pan.status != PtuStatus::Ok ? pan : tilt);
}

PtuAnswer change_mode(const CpiCall& call) {
  PtuConfig& config = call.head().config;
  switch (call.opcode()) {
    case kLimitsOn:
      config.limits = PtuLimits::Factory;
      break;
    case kLimitsOff:
      config.limits = PtuLimits::Disabled;
      break;
    case kImmediate:
      call.head().set_execution(PtuExecution::Immediate, call.now);
      break;
    case kSlaved:
      call.head().set_execution(PtuExecution::Slaved, call.now);
      break;
    case kEchoOn:
      config.echo = PtuEcho::On;
      break;
    case kEchoOff:
      config.echo = PtuEcho::Off;
      break;
    case kVerbose:
      config.feedback = PtuFeedback::Verbose;
      break;
    case kTerse:
      config.feedback = PtuFeedback::Terse;
      break;
    case kIndependent:
      call.head().set_control(PtuControl::Independent, call.now);
      break;
    case kVelocity:
      call.head().set_control(PtuControl::Velocity, call.now);
      break;
    default:
      return status(PtuStatus::IllegalCommand);
  }
  return status(PtuStatus::Ok);
}

PtuAnswer do_command(const CpiCall& call) {
  switch (call.opcode()) {
    case kAwait:
      call.head().release(call.now);
      return waiting(status(PtuStatus::Ok), PtuAnswer::Wait::Motion);
    case kHalt:
    case kHaltPan:
    case kHaltTilt:
      return halt(call);
    case kReset:
      return waiting(status(PtuStatus::Ok), PtuAnswer::Wait::Reset);
    case kResetOnPowerUp:
    case kNoResetOnPowerUp:
      return status(PtuStatus::NotSupported);
    case kSave:
      call.unit.save();
      return status(PtuStatus::Ok);
    case kRestore:
      call.unit.restore();
      return status(PtuStatus::Ok);
    case kFactory:
      call.unit.restore_factory();
      return status(PtuStatus::Ok);
    default:
      return change_mode(call);
  }
}

PtuAnswer do_later_command(const CpiCall& call) {
  PtuAnswer answer = waiting(status(PtuStatus::Ok), PtuAnswer::Wait::Reset);
  switch (call.opcode()) {
    case kResetPan:
      answer.reset = {true, false};
      return answer;
    case kResetTilt:
      answer.reset = {false, true};
      return answer;
    case kSetMotion:
      return judged(call.head().set_motion(
          {call.signed_word(0), call.signed_word(1), call.word(2), call.word(3)}, call.now));
    case kEnvironment:
      return status(PtuStatus::NotSupported);
    case kSetVelocities:
      return set_velocities(call);
    default:
      return status(PtuStatus::IllegalCommand);
  }
}

}  // namespace

std::size_t cpi_argument_size(std::uint8_t opcode, PtuSeries series) {
  if (opcode <= kSelectUnit) {
    return 2;
  }
  if (opcode >= kFirstPower && opcode <= kLastPower) {
    return 1;
  }
  if (opcode == kPanAcceleration || opcode == kTiltAcceleration) {
    return 4;
  }
  if (series == PtuSeries::E && (opcode == kSetMotion || opcode == kSetVelocities)) {
    return opcode == kSetMotion ? 8 : 5;
  }
  return 0;
}

PtuAnswer obey_cpi(PtuUnit& unit, std::span<const std::uint8_t> command, Stamp now) {
  const CpiCall call{unit, command, now};
  const std::uint8_t opcode = call.opcode();
  if (opcode <= kSelectUnit) {
    return set_word(call);
  }
  if (const auto told = query_cpi(unit, opcode, now)) {
    return {.bytes = *told, .form = PtuForm::Binary};
  }
  if (opcode >= kFirstPower && opcode <= kLastPower) {
    return set_power(call);
  }
  if (opcode == kPanAcceleration || opcode == kTiltAcceleration) {
    return set_acceleration(call);
  }
  const bool is_later = opcode >= kResetPan;
  if (is_later && unit.settings.model.series != PtuSeries::E) {
    return status(PtuStatus::IllegalCommand);
  }
  return is_later ? do_later_command(call) : do_command(call);
}

}  // namespace slamsensor::tools
