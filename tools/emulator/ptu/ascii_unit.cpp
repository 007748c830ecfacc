// Commands of the controller: what it says and remembers, its lines.
#include "tools/emulator/ptu/ascii_handlers.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::tools {
namespace {

const PtuWording& words(const AsciiCall& call) {
  return call.unit.settings.wording;
}

PtuAnswer echo(const AsciiCall& call) {
  const bool is_on = call.unit.head.config.echo == PtuEcho::On;
  return call.text(is_on ? words(call).echo_on : words(call).echo_off);
}

PtuAnswer set_echo(const AsciiCall& call) {
  call.unit.head.config.echo = call.command.letters == "EE" ? PtuEcho::On : PtuEcho::Off;
  return call.ok();
}

PtuAnswer feedback(const AsciiCall& call) {
  const bool is_verbose = call.unit.head.config.feedback == PtuFeedback::Verbose;
  return call.text(is_verbose ? words(call).verbose : words(call).terse);
}

PtuAnswer set_feedback(const AsciiCall& call) {
  const bool is_verbose = call.command.letters == "FV";
  call.unit.head.config.feedback = is_verbose ? PtuFeedback::Verbose : PtuFeedback::Terse;
  return call.ok();
}

PtuAnswer version(const AsciiCall& call) {
  return call.text(words(call).version);
}

PtuAnswer model(const AsciiCall& call) {
  return call.text(call.unit.settings.model.name);
}

PtuAnswer serial_number(const AsciiCall& call) {
  return call.text("00000001");
}

PtuAnswer environment(const AsciiCall& call) {
  return call.text(words(call).environment, words(call).environment_terse);
}

PtuAnswer save(const AsciiCall& call) {
  call.unit.save();
  return call.ok();
}

PtuAnswer restore(const AsciiCall& call) {
  call.unit.restore();
  return call.ok();
}

PtuAnswer restore_factory(const AsciiCall& call) {
  call.unit.restore_factory();
  return call.ok();
}

PtuAnswer unit_id(const AsciiCall& call) {
  constexpr long kUnitMax = 127;
  std::uint8_t& id = call.unit.head.config.unit_id;
  if (call.command.is_query()) {
    const std::string number = std::to_string(id);
    return call.text(worded(words(call).unit_id, {}, number), number);
  }
  const auto value = call.command.number();
  if (!value || *value < 0 || *value > kUnitMax) {
    return call.illegal();
  }
  id = static_cast<std::uint8_t>(*value);
  call.unit.selected_unit = id;
  return call.ok();
}

// Is never answered: several units hear it.
PtuAnswer select_unit(const AsciiCall& call) {
  if (const auto value = call.command.number()) {
    call.unit.selected_unit = static_cast<int>(*value);
  }
  return {};
}

PtuAnswer compatibility(const AsciiCall& call) {
  PtuSwitch& mode = call.unit.head.config.compatibility;
  const std::string& letters = call.command.letters;
  if (letters == "CM") {
    return call.text(mode == PtuSwitch::On ? "Compatibility mode ENABLED" : "Compatibility mode DISABLED");
  }
  mode = letters == "CME" ? PtuSwitch::On : PtuSwitch::Off;
  return call.ok();
}

// What stands between brackets, cut at the commas; empty when the brackets are not there.
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

// "@(baud,delay,T|F)" for the host's line; "@" alone turns from an expansion port back to the unit.
PtuAnswer host_port(const AsciiCall& call) {
  if (call.command.is_query()) {
    return call.ok();
  }
  const std::vector<std::string> parts = bracketed(call.command.argument);
  if (parts.size() != 3 || call.unit.is_networked() || (parts[2] != "T" && parts[2] != "F")) {
    return call.illegal();
  }
  const auto rate = AsciiCommand{{}, parts[0]}.number();
  const auto delay = AsciiCommand{{}, parts[1]}.number();
  const auto& known = call.unit.settings.bauds;
  if (!rate || !delay || *rate <= 0 || *delay < 0 ||
      std::find(known.begin(), known.end(), static_cast<std::uint32_t>(*rate)) == known.end()) {
    return call.illegal();
  }
  PtuAnswer answer = call.ok();
  answer.baud = static_cast<std::uint32_t>(*rate);
  if (parts[2] == "T") {
    call.unit.saved.start_baud = *answer.baud;
    call.unit.head.config.start_baud = *answer.baud;
  }
  return answer;
}

bool is_one_of(const std::string& word, std::string_view letters) {
  return word.size() == 1 && letters.find(word[0]) != std::string_view::npos;
}

// "@A(baud,data,parity,handshake)" of an expansion port, "@A" to talk to it, "@A<n>" for n bytes of talk.
PtuAnswer expansion_port(const AsciiCall& call) {
  if (call.command.is_query()) {
    call.unit.pass_through = PtuPassThrough{};
    return call.ok();
  }
  if (const auto bytes = call.command.number()) {
    if (*bytes < 1) {
      return call.illegal();
    }
    call.unit.pass_through = PtuPassThrough{static_cast<std::size_t>(*bytes)};
    return call.ok();
  }
  constexpr std::array<long, 6> kRates = {300, 1200, 2400, 4800, 9600, 19200};
  const std::vector<std::string> parts = bracketed(call.command.argument);
  if (parts.size() != 4) {
    return call.illegal();
  }
  const auto rate = AsciiCommand{{}, parts[0]}.number();
  const bool is_rate = rate && std::find(kRates.begin(), kRates.end(), *rate) != kRates.end();
  const bool is_format =
      is_one_of(parts[1], "78") && is_one_of(parts[2], "NEO") && is_one_of(parts[3], "NHXF");
  return is_rate && is_format ? call.ok() : call.illegal();
}

PtuAnswer menu(const AsciiCall& call) {
  constexpr std::array<std::string_view, 12> kLines = {
      "PP TP  absolute position          PO TO  offset position",
      "PS TS  speed                      PD TD  speed offset",
      "PA TA  acceleration               PB TB  base speed",
      "PU TU  upper speed limit          PL TL  lower speed limit",
      "PN TN  minimum position           PX TX  maximum position",
      "PR TR  resolution                 PH TH  hold power   PM TM  move power",
      "I S    immediate, slaved          A      await completion",
      "H      halt                       M      monitor",
      "L      position limits            C      speed control mode",
      "XS XG XC  presets                 R      reset",
      "E      echo                       F      feedback",
      "D      defaults                   V O U @  version, supply, unit, ports"};
  const std::string& end = call.unit.settings.line_end;
  PtuAnswer answer = call.ok();
  for (const std::string_view line : kLines) {
    answer.bytes += std::string(line) + end;
  }
  return answer;
}

constexpr auto kE = PtuSeries::E;
constexpr std::array<AsciiEntry, 23> kUnitTable = {{
    {"E", echo},
    {"EE", set_echo},
    {"ED", set_echo},
    {"F", feedback},
    {"FV", set_feedback},
    {"FT", set_feedback},
    {"V", version},
    {"VV", version, kE},
    {"VM", model, kE},
    {"VS", serial_number, kE},
    {"O", environment},
    {"DS", save},
    {"DR", restore},
    {"DF", restore_factory},
    {"U", unit_id},
    {"_", select_unit},
    {"CM", compatibility, kE},
    {"CME", compatibility, kE},
    {"CMD", compatibility, kE},
    {"@", host_port},
    {"@A", expansion_port},
    {"@B", expansion_port},
    {"?", menu},
}};

}  // namespace

AsciiHandler find_unit_handler(std::string_view letters, PtuSeries series) {
  return find_in(kUnitTable, letters, series);
}

}  // namespace slamsensor::tools
