// Commands of one axis.
#include "tools/emulator/ptu/ascii_handlers.hpp"

#include <array>
#include <cstdio>

namespace slamsensor::tools {
namespace {

PtuAxisId axis_of(const AsciiCall& call) {
  const std::string& letters = call.command.letters;
  const char letter = letters[0] == 'W' ? letters[1] : letters[0];
  return letter == 'P' ? PtuAxisId::Pan : PtuAxisId::Tilt;
}

std::string_view name_of(PtuAxisId id) {
  return id == PtuAxisId::Pan ? "Pan" : "Tilt";
}

PtuAnswer tell(const AsciiCall& call, const std::string& pattern, const std::string& value) {
  return call.text(worded(pattern, name_of(axis_of(call)), value), value);
}

PtuAnswer tell(const AsciiCall& call, const std::string& pattern, long value) {
  return tell(call, pattern, std::to_string(value));
}

const PtuWording& words(const AsciiCall& call) {
  return call.unit.settings.wording;
}

PtuAnswer position(const AsciiCall& call) {
  PtuHead& head = call.unit.head;
  const PtuAxisId id = axis_of(call);
  if (call.command.is_query()) {
    const Stamp seen = call.now - call.unit.settings.position_latency;
    return tell(call, words(call).current_position, head.axis(id).position(seen));
  }
  const auto target = call.command.number();
  return target ? call.judged(head.set_position(id, *target, call.now)) : call.illegal();
}

PtuAnswer offset(const AsciiCall& call) {
  PtuHead& head = call.unit.head;
  const PtuAxisId id = axis_of(call);
  const long current = head.axis(id).position(call.now);
  if (call.command.is_query()) {
    const bool is_desired = call.unit.settings.offset_query == PtuOffsetQuery::Desired;
    return tell(call, words(call).desired_position, is_desired ? head.axis(id).target() : current);
  }
  const auto steps = call.command.number();
  return steps ? call.judged(head.set_position(id, current + *steps, call.now)) : call.illegal();
}

PtuAnswer speed(const AsciiCall& call) {
  PtuHead& head = call.unit.head;
  const PtuAxisId id = axis_of(call);
  if (call.command.is_query()) {
    return tell(call, words(call).desired_speed, head.desired_speed(id));
  }
  const auto value = call.command.number();
  return value ? call.judged(head.set_speed(id, *value, call.now)) : call.illegal();
}

PtuAnswer speed_offset(const AsciiCall& call) {
  PtuHead& head = call.unit.head;
  const PtuAxisId id = axis_of(call);
  const long current = head.current_speed(id, call.now);
  if (call.command.is_query()) {
    return tell(call, words(call).current_speed, current);
  }
  const auto value = call.command.number();
  return value ? call.judged(head.set_speed(id, current + *value, call.now)) : call.illegal();
}

using TableSetter = PtuVerdict (PtuHead::*)(PtuAxisId, long, Stamp);

// Sets what the speed tables are computed from: the answer comes when they are.
PtuAnswer set_table(const AsciiCall& call, TableSetter set, Stamp time) {
  const auto value = call.command.number();
  if (!value) {
    return call.illegal();
  }
  const PtuVerdict verdict = (call.unit.head.*set)(axis_of(call), *value, call.now);
  PtuAnswer answer = call.judged(verdict);
  if (verdict.status == PtuStatus::Ok) {
    answer.wait = PtuAnswer::Wait::Time;
    answer.time = time;
  }
  return answer;
}

PtuAnswer acceleration(const AsciiCall& call) {
  if (call.command.is_query()) {
    return tell(
        call, words(call).acceleration,
        call.unit.head.parameters(axis_of(call)).acceleration + call.unit.settings.acceleration_read_back);
  }
  return set_table(call, &PtuHead::set_acceleration, call.unit.settings.table_times.acceleration);
}

PtuAnswer base_speed(const AsciiCall& call) {
  if (call.command.is_query()) {
    return tell(call, words(call).base_speed, call.unit.head.parameters(axis_of(call)).base_speed);
  }
  return set_table(call, &PtuHead::set_base_speed, call.unit.settings.table_times.base);
}

PtuAnswer upper_speed(const AsciiCall& call) {
  if (call.command.is_query()) {
    return tell(call, words(call).max_speed, call.unit.head.parameters(axis_of(call)).upper_speed);
  }
  return set_table(call, &PtuHead::set_upper_speed, call.unit.settings.table_times.upper);
}

PtuAnswer lower_speed(const AsciiCall& call) {
  if (call.command.is_query()) {
    return tell(call, words(call).min_speed, call.unit.head.parameters(axis_of(call)).lower_speed);
  }
  return set_table(call, &PtuHead::set_lower_speed, call.unit.settings.table_times.lower);
}

PtuAnswer min_position(const AsciiCall& call) {
  return call.command.is_query()
             ? tell(call, words(call).min_position, call.unit.head.axis(axis_of(call)).min())
             : call.illegal();
}

PtuAnswer max_position(const AsciiCall& call) {
  return call.command.is_query()
             ? tell(call, words(call).max_position, call.unit.head.axis(axis_of(call)).max())
             : call.illegal();
}

// User limits lie within the factory's and enclose home.
PtuAnswer user_min(const AsciiCall& call) {
  const PtuAxis& axis = call.unit.head.axis(axis_of(call));
  PtuAxisConfig& own = call.unit.head.parameters(axis_of(call));
  if (call.command.is_query()) {
    return tell(call, words(call).min_user_position, own.user_min.value_or(axis.min()));
  }
  const auto value = call.command.number();
  if (!value || *value > 0 || *value < axis.min()) {
    return call.illegal();
  }
  own.user_min = *value;
  return call.ok();
}

PtuAnswer user_max(const AsciiCall& call) {
  const PtuAxis& axis = call.unit.head.axis(axis_of(call));
  PtuAxisConfig& own = call.unit.head.parameters(axis_of(call));
  if (call.command.is_query()) {
    return tell(call, words(call).max_user_position, own.user_max.value_or(axis.max()));
  }
  const auto value = call.command.number();
  if (!value || *value < 0 || *value > axis.max()) {
    return call.illegal();
  }
  own.user_max = *value;
  return call.ok();
}

PtuAnswer resolution(const AsciiCall& call) {
  if (!call.command.is_query()) {
    return call.illegal();
  }
  const int decimals = call.unit.settings.model.series == PtuSeries::E ? 6 : 4;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals,
                call.unit.head.axis(axis_of(call)).resolution_arcsec());
  return tell(call, words(call).resolution, text.data());
}

PtuAnswer power(const AsciiCall& call) {
  constexpr std::array<std::string_view, 5> kLong = {"", "HIGH", "REGULAR", "LOW", "OFF"};
  constexpr std::array<std::string_view, 5> kShort = {"", "HIGH", "REG", "LOW", "OFF"};
  const std::string& letters = call.command.letters;
  PtuAxisConfig& own = call.unit.head.parameters(axis_of(call));
  const bool is_hold = letters[1] == 'H';
  PtuPower& power = is_hold ? own.hold_power : own.move_power;
  if (!call.command.is_query()) {
    return call.illegal();
  }
  if (letters.size() == 2) {
    const auto index = static_cast<std::size_t>(power);
    const std::string& pattern = is_hold ? words(call).hold_power : words(call).move_power;
    return call.text(worded(pattern, name_of(axis_of(call)), kLong[index]), kShort[index]);
  }
  switch (letters[2]) {
    case 'H':
      power = PtuPower::High;
      break;
    case 'R':
      power = PtuPower::Regular;
      break;
    case 'L':
      power = PtuPower::Low;
      break;
    default:
      power = PtuPower::Off;
  }
  return call.ok();
}

PtuAnswer step_mode(const AsciiCall& call) {
  char& mode = call.unit.head.parameters(axis_of(call)).step_mode;
  if (!call.command.is_query()) {
    return call.illegal();
  }
  if (call.command.letters.size() == 2) {
    constexpr std::array<std::string_view, 5> kNames = {"FULL", "HALF", "QUARTER", "EIGHTH", "AUTO"};
    return call.text(kNames[std::string_view("FHQEA").find(mode)]);
  }
  mode = call.command.letters[2];
  return call.ok();
}

constexpr std::array<AsciiEntry, 21> kAxisTable = {{
    {"P", position},
    {"O", offset},
    {"S", speed},
    {"D", speed_offset},
    {"A", acceleration},
    {"B", base_speed},
    {"U", upper_speed},
    {"L", lower_speed},
    {"N", min_position},
    {"X", max_position},
    {"NU", user_min, PtuSeries::E},
    {"XU", user_max, PtuSeries::E},
    {"R", resolution},
    {"H", power},
    {"HR", power},
    {"HL", power},
    {"HO", power},
    {"M", power},
    {"MH", power},
    {"MR", power},
    {"ML", power},
}};

}  // namespace

AsciiHandler find_axis_handler(std::string_view letters, PtuSeries series) {
  if (letters.size() < 2) {
    return nullptr;
  }
  if (letters[0] == 'P' || letters[0] == 'T') {
    return find_in(kAxisTable, letters.substr(1), series);
  }
  const bool is_step_mode = letters[0] == 'W' && (letters[1] == 'P' || letters[1] == 'T');
  const std::string_view mode = letters.substr(2);
  const bool is_known = mode.empty() || (mode.size() == 1 && mode.find_first_of("FHQEA") == 0);
  return is_step_mode && is_known && series == PtuSeries::E ? step_mode : nullptr;
}

}  // namespace slamsensor::tools
