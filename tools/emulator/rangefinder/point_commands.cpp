#include "tools/emulator/rangefinder/point_commands.hpp"

#include "tools/emulator/rangefinder/point_line.hpp"
#include "tools/emulator/rangefinder/point_rate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::string_view kLineEnd = "\r\n";
constexpr double kFrequencyMax_hz = 40'000.0;

struct Parameter {
  std::string_view command;
  std::string_view label;
  std::string_view factory;
  bool is_ldm41e = false;
};

/// In the order of the manual's parameter list.
constexpr std::array<Parameter, 17> kParameters = {{{"MF", "measure frequency", "1000"},
                                                    {"SA", "average value", "1", true},
                                                    {"MW", "measure window", "-290.000 290.000 0"},
                                                    {"TI", "trigger in", "0"},
                                                    {"TO", "trigger out", "0"},
                                                    {"OF", "distance offset", "0.000", true},
                                                    {"SE", "error mode", "1", true},
                                                    {"Q1", "digital out", "0.000 1.000 0.050 1"},
                                                    {"Q2", "digital out", "0.000 1.000 0.050 1"},
                                                    {"QA", "analog out", "0.000 1.000"},
                                                    {"GN", "receiver gain", "0"},
                                                    {"BR", "serial baud rate", "115200", true},
                                                    {"SD", "serial output format", "0 0", true},
                                                    {"UB", "unit for binary output", "1000.000"},
                                                    {"TE", "serial output terminator", "0", true},
                                                    {"AS", "autostart command", "DT", true},
                                                    {"ST", "select target", "0", true}}};

std::uint32_t nearest_baud(PointDialect dialect, double baud) {
  constexpr std::array<std::uint32_t, 7> kLds70a = {9600,    19'200,  115200,   230'400,
                                                    460'800, 921'600, 2'000'000};
  constexpr std::array<std::uint32_t, 5> kLdm41e = {2400, 4800, 9600, 19'200, 38'400};
  const auto nearest = [baud](const auto& bauds) {
    return *std::ranges::min_element(bauds, {}, [baud](std::uint32_t each) { return std::abs(each - baud); });
  };
  return dialect == PointDialect::Ldm41e ? nearest(kLdm41e) : nearest(kLds70a);
}

bool is_parameter(PointDialect dialect, std::string_view command) {
  const auto* const found = std::ranges::find(kParameters, command, &Parameter::command);
  return found != kParameters.end() && (dialect == PointDialect::Lds70a || found->is_ldm41e);
}

}  // namespace

PointCommands::PointCommands(const PointSettings& settings)
    : settings_(settings), format_(settings.format), baud_(settings.baud) {
  load_factory();
  values_["AS"] = settings.autostart;
  frequency_hz_ = settings.rate_hz;
  values_["MF"] = fixed_text(settings.rate_hz, 0);
}

void PointCommands::load_factory() {
  for (const Parameter& each : kParameters) {
    values_[std::string(each.command)] = each.factory;
  }
  format_ = settings_.format;
  const bool is_lds70a = settings_.dialect == PointDialect::Lds70a;
  const bool is_binary = !is_text(format_.coding);
  values_["SD"] =
      is_lds70a ? std::string(is_binary ? "2 " : "0 ") + std::to_string(static_cast<unsigned>(format_.extras))
                : "d";
  values_["UB"] = fixed_text(format_.units_per_m, 3);
  values_["BR"] = std::to_string(baud_);
  frequency_hz_ = is_lds70a ? 1000.0 : settings_.rate_hz;
  average_ = 1.0;
  offset_m_ = 0.0;
  window_min_m_ = -290.0;
  window_max_m_ = 290.0;
}

PointAnswer PointCommands::run(std::string_view line) {
  const std::string text = upper(trimmed(line));
  const std::string command = text.substr(0, 2);
  const std::string_view values =
      trimmed(std::string_view(text).substr(std::min<std::size_t>(2, text.size())));
  if (values.empty()) {
    if (const auto action = action_of(command)) {
      return {"", *action};
    }
  }
  if (command == "PR" && values.empty()) {
    load_factory();
    return {parameter_list(), PointAction::Stop};
  }
  if (const auto answer = text_of(text)) {
    return {*answer, PointAction::None};
  }
  const bool is_known = is_parameter(settings_.dialect, command);
  if (!is_known || (!values.empty() && !set(command, values))) {
    return {"?" + std::string(kLineEnd), PointAction::None};
  }
  return {command + " " + values_.at(command) + std::string(kLineEnd), PointAction::None};
}

std::optional<PointAction> PointCommands::action_of(std::string_view command) const {
  if (command == "DM") {
    return PointAction::Measure;
  }
  if (command == "DT") {
    return PointAction::Track;
  }
  return command == "DR" ? std::optional(PointAction::Restart) : std::nullopt;
}

std::optional<std::string> PointCommands::text_of(std::string_view command) const {
  const std::string end(kLineEnd);
  if (command == "ID") {
    return settings_.identity + end;
  }
  if (command == "TP") {
    return "TP 23.5" + end;
  }
  if (command == "TC" && settings_.dialect == PointDialect::Lds70a) {
    return "TC 1" + end;
  }
  if (command == "HW" && settings_.dialect == PointDialect::Lds70a) {
    return hardware_text();
  }
  if (command == "PA") {
    return parameter_list();
  }
  if (command == "ID?") {
    std::string list = "ID ID? DM DT DR TP HW PA PR";
    for (const Parameter& each : kParameters) {
      list += is_parameter(settings_.dialect, each.command) ? " " + std::string(each.command) : "";
    }
    return list + end;
  }
  return std::nullopt;
}

std::string PointCommands::hardware_text() const {
  // Classes of the manual's table 4, in the order of SightKind.
  constexpr std::array<std::string_view, 5> kClasses = {"6", "0", "3", "2", "5"};
  const std::string end(kLineEnd);
  const std::string error = last_kind_ == SightKind::Error ? "DE04" : "0";
  return "Error code: " + error + end + "Temp (Board): 23.5" + end + "Laser-Voltage: 120" + end +
         "Measure result: " + std::string(kClasses[static_cast<std::size_t>(last_kind_)]) + end;
}

std::string PointCommands::parameter_list() const {
  constexpr std::size_t kColumn = 33;
  std::string list;
  for (const Parameter& each : kParameters) {
    if (!is_parameter(settings_.dialect, each.command)) {
      continue;
    }
    std::string label = std::string(each.label) + "[" + std::string(each.command) + "]";
    label.resize(std::max(kColumn, label.size() + 1), '.');
    list += label + values_.at(std::string(each.command));
    list += each.command == "MF" ? "(max 40000)Hz" : "";
    list += kLineEnd;
  }
  return list;
}

bool PointCommands::set(const std::string& command, std::string_view values) {
  if (command == "AS") {
    values_["AS"] = values;
    return true;
  }
  if (command == "SD" && settings_.dialect == PointDialect::Ldm41e) {
    return set_letter_format(values);
  }
  const auto numbers = numbers_in(values);
  if (!numbers || numbers->empty()) {
    return false;
  }
  values_[command] = values;
  return set_numbers(command, *numbers);
}

bool PointCommands::set_numbers(const std::string& command, const Numbers& numbers) {
  const double first = numbers.front();
  if (command == "MF") {
    frequency_hz_ = std::clamp(first, 1.0, kFrequencyMax_hz);
    values_[command] = fixed_text(frequency_hz_, 0);
  } else if (command == "SA") {
    average_ = std::clamp(first, 1.0, 30'000.0);
    values_[command] = fixed_text(average_, 0);
  } else if (command == "OF") {
    offset_m_ = first;
    values_[command] = fixed_text(first, 3);
  } else if (command == "MW" && numbers.size() >= 2) {
    window_min_m_ = first;
    window_max_m_ = numbers[1];
    values_[command] = fixed_text(first, 3) + " " + fixed_text(numbers[1], 3) + " " +
                       fixed_text(numbers.size() > 2 ? numbers[2] : 0.0, 0);
  } else if (command == "BR") {
    set_baud(nearest_baud(settings_.dialect, first));
  } else if (command == "UB") {
    set_binary_unit(first);
  } else if (command == "TE") {
    return set_terminator(first);
  } else if (command == "SD") {
    return set_format(numbers);
  }
  return true;
}

void PointCommands::set_binary_unit(double units_per_m) {
  format_.units_per_m = std::clamp(units_per_m, 0.001, 1e6);
  values_["UB"] = fixed_text(format_.units_per_m, 3);
}

bool PointCommands::set_format(const Numbers& numbers) {
  const double extras = numbers.size() > 1 ? numbers[1] : 0.0;
  const bool is_binary = numbers[0] == 2.0;
  if ((numbers[0] != 0.0 && !is_binary) || !(extras >= 0.0 && extras <= 3.0)) {
    values_["SD"] = "0 0";
    return false;
  }
  const bool was_binary = !is_text(settings_.format.coding);
  format_.coding = !is_binary   ? PointCoding::Decimal
                   : was_binary ? settings_.format.coding
                                : PointCoding::SevenBit;
  format_.extras = static_cast<PointExtras>(static_cast<unsigned>(extras));
  values_["SD"] = std::string(is_binary ? "2 " : "0 ") + fixed_text(std::floor(extras), 0);
  return true;
}

bool PointCommands::set_letter_format(std::string_view letter) {
  if (letter != "D" && letter != "H" && letter != "S") {
    return false;
  }
  format_.coding = letter == "H" ? PointCoding::Hex : PointCoding::Decimal;
  format_.prefix = letter == "H" ? " " : "";
  format_.extras = letter == "S" ? PointExtras::Quality : PointExtras::None;
  values_["SD"] = letter == "D" ? "d" : (letter == "H" ? "h" : "s");
  return true;
}

bool PointCommands::set_terminator(double code) {
  constexpr std::array<std::string_view, 10> kTerminators = {"\r\n", "\r", "\n", "\x02", "\x03",
                                                             "\t",   " ",  ",",  ":",    ";"};
  if (!(code >= 0.0 && code < static_cast<double>(kTerminators.size()))) {
    values_["TE"] = "0";
    return false;
  }
  format_.terminator = kTerminators[static_cast<std::size_t>(code)];
  return true;
}

void PointCommands::set_baud(std::uint32_t baud) {
  baud_ = baud;
  values_["BR"] = std::to_string(baud);
}

double PointCommands::rate_hz() const {
  const double wanted_hz = frequency_hz_ / average_;
  if (settings_.dialect != PointDialect::Lds70a) {
    return settings_.rate_hz;
  }
  const std::size_t bytes = point_record_bytes(format_);
  const double carried_hz =
      baud_ / (10.0 * static_cast<double>(bytes));  // the table allows 1 % more at times
  return std::min({wanted_hz, carried_hz, lds70a_rate_max_hz(baud_, format_.coding, bytes)});
}

}  // namespace slamsensor::tools
