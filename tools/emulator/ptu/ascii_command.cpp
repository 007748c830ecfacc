#include "tools/emulator/ptu/ascii_command.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <vector>

namespace slamsensor::tools {
namespace {

std::optional<long> to_number(std::string_view text) {
  constexpr std::size_t kDigitsMax = 9;
  const bool is_signed = !text.empty() && (text[0] == '-' || text[0] == '+');
  const std::string_view digits = text.substr(is_signed ? 1 : 0);
  if (digits.empty() || digits.size() > kDigitsMax) {
    return std::nullopt;
  }
  long value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    return std::nullopt;
  }
  return text[0] == '-' ? -value : value;
}

/// A command on its way through a handler, with the ways to answer it.
struct AsciiCall {
  PtuUnit& unit;
  std::string letters;   ///< of the command, in capitals
  std::string argument;  ///< what follows them
  Stamp now;

  [[nodiscard]] bool is_query() const noexcept { return argument.empty(); }

  /// The argument as a signed decimal number of at most nine digits; nothing when it is none.
  [[nodiscard]] std::optional<long> number() const { return to_number(argument); }

  [[nodiscard]] const PtuWording& words() const { return unit.settings.wording; }
  [[nodiscard]] PtuHead& head() const { return unit.head; }

  /// Of a command of one axis.
  [[nodiscard]] PtuAxisId axis() const { return letters[0] == 'P' ? PtuAxisId::Pan : PtuAxisId::Tilt; }
  [[nodiscard]] PtuAxisConfig& parameters() const { return unit.head.parameters(axis()); }

  [[nodiscard]] AsciiAnswer ok() const { return {.bytes = "*\r\n"}; }
  [[nodiscard]] AsciiAnswer text(std::string_view said) const {
    return {.bytes = "* " + std::string(said) + "\r\n"};
  }
  [[nodiscard]] AsciiAnswer text(std::string_view said, std::string_view terse) const {
    return text(unit.head.config.feedback == PtuFeedback::Verbose ? said : terse);
  }
  [[nodiscard]] AsciiAnswer error(std::string_view said) const {
    return {.bytes = "! " + std::string(said) + "\r\n"};
  }
  [[nodiscard]] AsciiAnswer illegal() const { return error(words().illegal_argument); }
  [[nodiscard]] AsciiAnswer judged(const PtuRefusal& refusal) const {
    return refusal.empty() ? ok() : error(refusal);
  }

  /// `value` of the axis, in a sentence or alone.
  [[nodiscard]] AsciiAnswer report(const std::string& pattern, const std::string& value) const {
    return text(worded(pattern, axis() == PtuAxisId::Pan ? "Pan" : "Tilt", value), value);
  }
  [[nodiscard]] AsciiAnswer report(const std::string& pattern, long value) const {
    return report(pattern, std::to_string(value));
  }
};

using AsciiHandler = AsciiAnswer (*)(const AsciiCall&);

// Commands of one axis.

AsciiAnswer position(const AsciiCall& call) {
  if (call.is_query()) {
    const Stamp seen = call.now - call.unit.settings.position_latency;
    return call.report(call.words().current_position, call.head().axis(call.axis()).position(seen));
  }
  const auto target = call.number();
  return target ? call.judged(call.head().set_position(call.axis(), *target, call.now)) : call.illegal();
}

AsciiAnswer offset(const AsciiCall& call) {
  const StepperAxis& axis = call.head().axis(call.axis());
  if (call.is_query()) {
    return call.report(call.words().desired_position, axis.target());
  }
  const auto steps = call.number();
  return steps
             ? call.judged(call.head().set_position(call.axis(), axis.position(call.now) + *steps, call.now))
             : call.illegal();
}

AsciiAnswer speed(const AsciiCall& call) {
  if (call.is_query()) {
    return call.report(call.words().desired_speed, call.head().desired_speed(call.axis()));
  }
  const auto value = call.number();
  return value ? call.judged(call.head().set_speed(call.axis(), *value, call.now)) : call.illegal();
}

AsciiAnswer speed_offset(const AsciiCall& call) {
  const long current = call.head().current_speed(call.axis(), call.now);
  if (call.is_query()) {
    return call.report(call.words().current_speed, current);
  }
  const auto value = call.number();
  return value ? call.judged(call.head().set_speed(call.axis(), current + *value, call.now)) : call.illegal();
}

using TableSetter = PtuRefusal (PtuHead::*)(PtuAxisId, long, Stamp);

/// Sets what the speed tables are computed from: the answer comes when they are.
AsciiAnswer set_table(const AsciiCall& call, TableSetter set, Stamp time) {
  const auto value = call.number();
  if (!value) {
    return call.illegal();
  }
  const PtuRefusal refusal = (call.head().*set)(call.axis(), *value, call.now);
  AsciiAnswer answer = call.judged(refusal);
  if (refusal.empty()) {
    answer.wait = AsciiAnswer::Wait::Time;
    answer.time = time;
  }
  return answer;
}

AsciiAnswer acceleration(const AsciiCall& call) {
  return call.is_query()
             ? call.report(call.words().acceleration, call.parameters().acceleration)
             : set_table(call, &PtuHead::set_acceleration, call.unit.settings.table_times.acceleration);
}

AsciiAnswer base_speed(const AsciiCall& call) {
  return call.is_query() ? call.report(call.words().base_speed, call.parameters().base_speed)
                         : set_table(call, &PtuHead::set_base_speed, call.unit.settings.table_times.base);
}

AsciiAnswer upper_speed(const AsciiCall& call) {
  return call.is_query() ? call.report(call.words().max_speed, call.parameters().upper_speed)
                         : set_table(call, &PtuHead::set_upper_speed, call.unit.settings.table_times.upper);
}

AsciiAnswer lower_speed(const AsciiCall& call) {
  return call.is_query() ? call.report(call.words().min_speed, call.parameters().lower_speed)
                         : set_table(call, &PtuHead::set_lower_speed, call.unit.settings.table_times.lower);
}

AsciiAnswer min_position(const AsciiCall& call) {
  return call.is_query() ? call.report(call.words().min_position, call.head().axis(call.axis()).min())
                         : call.illegal();
}

AsciiAnswer max_position(const AsciiCall& call) {
  return call.is_query() ? call.report(call.words().max_position, call.head().axis(call.axis()).max())
                         : call.illegal();
}

AsciiAnswer resolution(const AsciiCall& call) {
  if (!call.is_query()) {
    return call.illegal();
  }
  const int decimals = call.unit.settings.model.series == PtuSeries::E ? 6 : 4;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals,
                call.head().axis(call.axis()).resolution_arcsec());
  return call.report(call.words().resolution, text.data());
}

// Commands that say how both axes move.

/// Obeys a word that has no argument.
template <typename Action>
AsciiAnswer plain(const AsciiCall& call, Action action) {
  if (!call.is_query()) {
    return call.illegal();
  }
  action();
  return call.ok();
}

AsciiAnswer set_execution(const AsciiCall& call) {
  const auto execution = call.letters == "I" ? PtuExecution::Immediate : PtuExecution::Slaved;
  return plain(call, [&] { call.head().set_execution(execution, call.now); });
}

AsciiAnswer await(const AsciiCall& call) {
  AsciiAnswer answer = plain(call, [&] { call.head().release(call.now); });
  answer.wait = call.is_query() ? AsciiAnswer::Wait::Motion : AsciiAnswer::Wait::None;
  return answer;
}

AsciiAnswer halt(const AsciiCall& call) {
  return plain(call, [&] {
    if (call.letters != "HT") {
      call.head().halt(PtuAxisId::Pan, call.now);
    }
    if (call.letters != "HP") {
      call.head().halt(PtuAxisId::Tilt, call.now);
    }
  });
}

AsciiAnswer control(const AsciiCall& call) {
  const bool is_independent = call.head().config.control == PtuControl::Independent;
  return call.text(is_independent ? call.words().independent : call.words().velocity);
}

AsciiAnswer set_control(const AsciiCall& call) {
  const auto control = call.letters == "CI" ? PtuControl::Independent : PtuControl::Velocity;
  return plain(call, [&] { call.head().set_control(control, call.now); });
}

AsciiAnswer limits(const AsciiCall& call) {
  const bool are_on = call.head().config.limits == PtuLimits::On;
  return call.text(are_on ? call.words().limits_on : call.words().limits_off);
}

AsciiAnswer set_limits(const AsciiCall& call) {
  return plain(call,
               [&] { call.head().config.limits = call.letters == "LE" ? PtuLimits::On : PtuLimits::Off; });
}

AsciiAnswer reset(const AsciiCall& call) {
  AsciiAnswer answer = call.ok();
  answer.wait = AsciiAnswer::Wait::Reset;
  return call.is_query() ? answer : call.illegal();
}

AsciiAnswer choose_reset(const AsciiCall& call) {
  const char letter = call.letters[1];
  const PtuAxes axes{letter == 'E' || letter == 'P', letter == 'E' || letter == 'T'};
  AsciiAnswer answer = plain(call, [&] { call.head().config.power_up_reset = axes; });
  const bool is_done = call.unit.settings.reset_words == PtuResetWords::ChooseAndReset;
  if (call.is_query() && is_done && axes.any()) {
    answer.wait = AsciiAnswer::Wait::Reset;
    answer.reset = axes;
  }
  return answer;
}

// Commands of the controller: what it says and remembers, its line.

AsciiAnswer echo(const AsciiCall& call) {
  return call.text(call.head().config.echo == PtuEcho::On ? "Echoing ON" : "Echoing OFF");
}

AsciiAnswer set_echo(const AsciiCall& call) {
  call.head().config.echo = call.letters == "EE" ? PtuEcho::On : PtuEcho::Off;
  return call.ok();
}

AsciiAnswer feedback(const AsciiCall& call) {
  const bool is_verbose = call.head().config.feedback == PtuFeedback::Verbose;
  return call.text(is_verbose ? "ASCII verbose mode" : "ASCII terse mode");
}

AsciiAnswer set_feedback(const AsciiCall& call) {
  call.head().config.feedback = call.letters == "FV" ? PtuFeedback::Verbose : PtuFeedback::Terse;
  return call.ok();
}

AsciiAnswer version(const AsciiCall& call) {
  return call.text(call.words().version);
}

AsciiAnswer environment(const AsciiCall& call) {
  return call.text("Input 30 VDC @ 86 degF", call.words().environment_terse);
}

AsciiAnswer save(const AsciiCall& call) {
  call.unit.save();
  return call.ok();
}

AsciiAnswer restore(const AsciiCall& call) {
  call.unit.restore();
  return call.ok();
}

AsciiAnswer restore_factory(const AsciiCall& call) {
  call.unit.restore_factory();
  return call.ok();
}

AsciiAnswer unit_id(const AsciiCall& call) {
  constexpr long kUnitMax = 127;
  std::uint8_t& id = call.head().config.unit_id;
  if (call.is_query()) {
    return call.text("Unit ID is " + std::to_string(id), std::to_string(id));
  }
  const auto value = call.number();
  if (!value || *value < 0 || *value > kUnitMax) {
    return call.illegal();
  }
  id = static_cast<std::uint8_t>(*value);
  call.unit.selected_unit = id;
  return call.ok();
}

/// Is never answered: several units hear it.
AsciiAnswer select_unit(const AsciiCall& call) {
  if (const auto value = call.number()) {
    call.unit.selected_unit = static_cast<int>(*value);
  }
  return {};
}

/// What stands between brackets, cut at the commas; empty when the brackets are not there.
std::vector<std::string> bracketed(std::string_view argument) {
  std::vector<std::string> parts;
  if (argument.size() < 2 || argument.front() != '(' || argument.back() != ')') {
    return parts;
  }
  argument = argument.substr(1, argument.size() - 2);
  for (std::size_t begin = 0; begin <= argument.size();) {
    const std::size_t end = std::min(argument.find(',', begin), argument.size());
    parts.emplace_back(argument.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// "@(baud,delay,T|F)" of the host's line; T: also after the next start.
AsciiAnswer host_port(const AsciiCall& call) {
  constexpr std::array<long, 9> kBauds = {600, 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
  if (call.is_query()) {
    return call.ok();
  }
  const std::vector<std::string> parts = bracketed(call.argument);
  if (parts.size() != 3 || call.unit.is_networked() || (parts[2] != "T" && parts[2] != "F")) {
    return call.illegal();
  }
  const auto rate = to_number(parts[0]);
  const auto delay = to_number(parts[1]);
  if (!rate || !delay || *delay < 0 || std::find(kBauds.begin(), kBauds.end(), *rate) == kBauds.end()) {
    return call.illegal();
  }
  AsciiAnswer answer = call.ok();
  answer.baud = static_cast<std::uint32_t>(*rate);
  if (parts[2] == "T") {
    call.unit.saved.start_baud = *answer.baud;
    call.head().config.start_baud = *answer.baud;
  }
  return answer;
}

struct AsciiEntry {
  std::string_view letters;
  AsciiHandler handler;
};

/// Of one axis: what follows P or T.
constexpr std::array<AsciiEntry, 11> kAxisTable = {{
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
    {"R", resolution},
}};

constexpr std::array<AsciiEntry, 31> kUnitTable = {{
    {"I", set_execution}, {"S", set_execution}, {"A", await},         {"H", halt},
    {"HP", halt},         {"HT", halt},         {"C", control},       {"CI", set_control},
    {"CV", set_control},  {"L", limits},        {"LE", set_limits},   {"LD", set_limits},
    {"R", reset},         {"RE", choose_reset}, {"RD", choose_reset}, {"RP", choose_reset},
    {"RT", choose_reset}, {"E", echo},          {"EE", set_echo},     {"ED", set_echo},
    {"F", feedback},      {"FV", set_feedback}, {"FT", set_feedback}, {"V", version},
    {"O", environment},   {"DS", save},         {"DR", restore},      {"DF", restore_factory},
    {"U", unit_id},       {"_", select_unit},   {"@", host_port},
}};

/// The handler of the command with exactly these letters; nullptr when there is none.
AsciiHandler find_handler(std::string_view letters) {
  const auto find_in = [](const auto& table, std::string_view word) {
    const auto found = std::find_if(table.begin(), table.end(),
                                    [word](const AsciiEntry& entry) { return entry.letters == word; });
    return found != table.end() ? found->handler : nullptr;
  };
  const bool is_of_axis = letters.size() >= 2 && (letters[0] == 'P' || letters[0] == 'T');
  return is_of_axis ? find_in(kAxisTable, letters.substr(1)) : find_in(kUnitTable, letters);
}

bool is_letter(char c) {
  return (c >= 'A' && c <= 'Z') || c == '@' || c == '_' || c == '?';
}

}  // namespace

AsciiAnswer obey_ascii(PtuUnit& unit, std::string_view text, Stamp now) {
  std::string capitals(text);
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  const auto end = std::find_if_not(capitals.begin(), capitals.end(), is_letter);
  const AsciiCall call{unit, std::string(capitals.begin(), end), std::string(end, capitals.end()), now};
  if (const AsciiHandler handler = find_handler(call.letters)) {
    return handler(call);
  }
  // Letters that go on after a command of two or more are taken for its argument.
  for (std::size_t size = call.letters.size(); size > 2; --size) {
    if (find_handler(std::string_view(call.letters).substr(0, size - 1)) != nullptr) {
      return call.illegal();
    }
  }
  return call.error(unit.settings.wording.illegal_command);
}

}  // namespace slamsensor::tools
