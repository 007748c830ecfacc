// Commands that say how both axes move.
#include "tools/emulator/ptu/ascii_handlers.hpp"

#include <array>

namespace slamsensor::tools {
namespace {

const PtuWording& words(const AsciiCall& call) {
  return call.unit.settings.wording;
}

// Obeys a word that has no argument.
template <typename Action>
PtuAnswer plain(const AsciiCall& call, Action action) {
  if (!call.command.is_query()) {
    return call.illegal();
  }
  action();
  return call.ok();
}

PtuAnswer immediate(const AsciiCall& call) {
  return plain(call, [&] { call.unit.head.set_execution(PtuExecution::Immediate, call.now); });
}

PtuAnswer slaved(const AsciiCall& call) {
  return plain(call, [&] { call.unit.head.set_execution(PtuExecution::Slaved, call.now); });
}

PtuAnswer execution(const AsciiCall& call) {
  const bool is_immediate = call.unit.head.config.execution == PtuExecution::Immediate;
  return call.text(is_immediate ? words(call).immediate : words(call).slaved);
}

PtuAnswer await(const AsciiCall& call) {
  PtuAnswer answer = plain(call, [&] { call.unit.head.release(call.now); });
  answer.wait = call.command.is_query() ? PtuAnswer::Wait::Motion : PtuAnswer::Wait::None;
  return answer;
}

PtuAnswer halt(const AsciiCall& call) {
  const std::string& letters = call.command.letters;
  return plain(call, [&] {
    if (letters != "HT") {
      call.unit.head.halt(PtuAxisId::Pan, call.now);
    }
    if (letters != "HP") {
      call.unit.head.halt(PtuAxisId::Tilt, call.now);
    }
  });
}

PtuAnswer control(const AsciiCall& call) {
  const bool is_independent = call.unit.head.config.control == PtuControl::Independent;
  return call.text(is_independent ? words(call).independent : words(call).velocity);
}

PtuAnswer independent(const AsciiCall& call) {
  return plain(call, [&] { call.unit.head.set_control(PtuControl::Independent, call.now); });
}

PtuAnswer velocity(const AsciiCall& call) {
  return plain(call, [&] { call.unit.head.set_control(PtuControl::Velocity, call.now); });
}

PtuAnswer limits(const AsciiCall& call) {
  switch (call.unit.head.config.limits) {
    case PtuLimits::Disabled:
      return call.text(words(call).limits_off);
    case PtuLimits::User:
      return call.text(words(call).limits_user);
    case PtuLimits::Factory:
      break;
  }
  return call.text(words(call).limits_on);
}

PtuAnswer set_limits(const AsciiCall& call) {
  const char which = call.command.letters[1];
  return plain(call, [&] {
    call.unit.head.config.limits = which == 'E'   ? PtuLimits::Factory
                                   : which == 'D' ? PtuLimits::Disabled
                                                  : PtuLimits::User;
  });
}

PtuAnswer preset(const AsciiCall& call) {
  constexpr long kPresetMax = 32;
  const auto number = call.command.number();
  if (!number || *number < 0 || *number > kPresetMax) {
    return call.illegal();
  }
  if (call.command.letters == "XG") {
    return call.judged(call.unit.head.go_to_preset(*number, call.now));
  }
  call.unit.head.save_preset(*number, call.now);
  return call.ok();
}

PtuAnswer clear_presets(const AsciiCall& call) {
  return plain(call, [&] { call.unit.head.clear_presets(); });
}

// Takes a range for the automatic scan; false when it is none or not within the limits.
bool define_monitor(PtuHead& head, const std::vector<long>& ends) {
  if ((ends.size() != 2 && ends.size() != 4) || ends[0] == ends[1]) {
    return false;
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const PtuAxisId id = i < 2 ? PtuAxisId::Pan : PtuAxisId::Tilt;
    if (head.check_position(id, ends[i]).status != PtuStatus::Ok) {
      return false;
    }
  }
  PtuMonitorRange range{ends[0], ends[1], std::nullopt};
  if (ends.size() == 4) {
    range.tilt = {ends[2], ends[3]};
  }
  head.config.monitor = range;
  return true;
}

PtuAnswer monitor(const AsciiCall& call) {
  if (!call.command.is_query()) {
    const auto ends = call.command.numbers();
    if (!ends || !define_monitor(call.unit.head, *ends)) {
      return call.illegal();
    }
  }
  call.unit.head.begin_monitor(call.now);
  return call.ok();
}

PtuAnswer set_monitor(const AsciiCall& call) {
  const char which = call.command.letters[1];
  return plain(call, [&] {
    call.unit.head.config.monitor_at_power_up = which == 'E' ? PtuSwitch::On : PtuSwitch::Off;
  });
}

PtuAnswer monitor_query(const AsciiCall& call) {
  const bool is_on = call.unit.head.config.monitor_at_power_up == PtuSwitch::On;
  return call.text(is_on ? "Monitor at power up ENABLED" : "Monitor at power up DISABLED");
}

PtuAnswer monitor_status(const AsciiCall& call) {
  const auto& range = call.unit.head.config.monitor;
  if (!range) {
    return call.text("Monitor range is not defined");
  }
  std::string ends = std::to_string(range->pan_from) + "," + std::to_string(range->pan_to);
  if (range->tilt) {
    ends += "," + std::to_string((*range->tilt)[0]) + "," + std::to_string((*range->tilt)[1]);
  }
  return call.text(ends);
}

PtuAnswer motion_query(const AsciiCall& call) {
  PtuHead& head = call.unit.head;
  const Stamp seen = call.now - call.unit.settings.position_latency;
  std::string words = std::to_string(head.axis(PtuAxisId::Pan).position(seen)) + "," +
                      std::to_string(head.axis(PtuAxisId::Tilt).position(seen)) + "," +
                      std::to_string(head.current_speed(PtuAxisId::Pan, seen)) + "," +
                      std::to_string(head.current_speed(PtuAxisId::Tilt, seen));
  if (call.command.letters == "BT") {
    words += "," + std::to_string(seen / std::chrono::milliseconds(1));
  }
  return call.text(words);
}

PtuAnswer motion(const AsciiCall& call) {
  if (call.command.is_query()) {
    return motion_query(call);
  }
  const auto values = call.command.numbers();
  if (!values || values->size() != kPtuAxes * 2) {
    return call.illegal();
  }
  return call.judged(
      call.unit.head.set_motion({(*values)[0], (*values)[1], (*values)[2], (*values)[3]}, call.now));
}

PtuAnswer motion_at_time(const AsciiCall& call) {
  return call.command.is_query() ? motion_query(call) : call.illegal();
}

PtuAxes axes_of(char letter) {
  return {letter == 'E' || letter == 'P', letter == 'E' || letter == 'T'};
}

PtuAnswer reset(const AsciiCall& call) {
  PtuAnswer answer = call.ok();
  answer.wait = PtuAnswer::Wait::Reset;
  return call.command.is_query() ? answer : call.illegal();
}

PtuAnswer choose_reset(const AsciiCall& call) {
  const PtuAxes axes = axes_of(call.command.letters[1]);
  PtuAnswer answer = plain(call, [&] { call.unit.head.config.power_up_reset = axes; });
  const bool is_done = call.unit.settings.reset_words == PtuResetWords::ChooseAndReset;
  if (call.command.is_query() && is_done && axes.any()) {
    answer.wait = PtuAnswer::Wait::Reset;
    answer.reset = axes;
  }
  return answer;
}

PtuAnswer reset_query(const AsciiCall& call) {
  const PtuAxes& axes = call.unit.head.config.power_up_reset;
  return call.text(axes.pan && axes.tilt ? "Reset at power up: pan and tilt"
                   : axes.pan            ? "Reset at power up: pan"
                   : axes.tilt           ? "Reset at power up: tilt"
                                         : "Reset at power up: none");
}

PtuAnswer reset_speed(const AsciiCall& call) {
  const PtuAxisId id = call.command.letters[1] == 'P' ? PtuAxisId::Pan : PtuAxisId::Tilt;
  long& speed = call.unit.head.config.reset_speeds[index_of(id)];
  if (call.command.is_query()) {
    return call.text(std::to_string(speed));
  }
  const auto value = call.command.number();
  if (!value || *value < 0) {
    return call.illegal();
  }
  speed = *value;
  return call.ok();
}

constexpr auto kE = PtuSeries::E;
constexpr std::array<AsciiEntry, 32> kModeTable = {{
    {"I", immediate},
    {"S", slaved},
    {"IQ", execution, kE},
    {"A", await},
    {"H", halt},
    {"HP", halt},
    {"HT", halt},
    {"C", control},
    {"CI", independent},
    {"CV", velocity},
    {"L", limits},
    {"LE", set_limits},
    {"LD", set_limits},
    {"LU", set_limits, kE},
    {"XS", preset},
    {"XG", preset},
    {"XC", clear_presets},
    {"M", monitor},
    {"ME", set_monitor},
    {"MD", set_monitor},
    {"MQ", monitor_query, kE},
    {"MS", monitor_status, kE},
    {"B", motion, kE},
    {"BT", motion_at_time, kE},
    {"R", reset},
    {"RE", choose_reset},
    {"RD", choose_reset},
    {"RP", choose_reset},
    {"RT", choose_reset},
    {"RQ", reset_query, kE},
    {"RPS", reset_speed, kE},
    {"RTS", reset_speed, kE},
}};

}  // namespace

AsciiHandler find_mode_handler(std::string_view letters, PtuSeries series) {
  return find_in(kModeTable, letters, series);
}

}  // namespace slamsensor::tools
