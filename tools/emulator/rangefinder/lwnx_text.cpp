#include "tools/emulator/rangefinder/lwnx_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

std::optional<LwnxTextKind> kind_of(std::string_view key) {
  using enum LwnxTextKind;
  constexpr std::array<std::pair<std::string_view, LwnxTextKind>, 9> kKeys = {{{"", Product},
                                                                               {"P", Product},
                                                                               {"L", Distance},
                                                                               {"LD", Distance},
                                                                               {"LDF", Distance},
                                                                               {"LDL", Distance},
                                                                               {"LH", Strength},
                                                                               {"LT", Temperature},
                                                                               {"CB", Baud}}};
  const auto* const found = std::ranges::find(kKeys, key, &std::pair<std::string_view, LwnxTextKind>::first);
  return found != kKeys.end() ? std::optional(found->second) : std::nullopt;
}

std::string changed(std::string_view text, int (*change)(int)) {
  std::string out;
  for (const char c : text) {
    out.push_back(static_cast<char>(change(static_cast<unsigned char>(c))));
  }
  return out;
}

std::optional<int> number_in(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

std::optional<LwnxTextKind> kind_with(char prefix, std::string_view key) {
  if (prefix == '%') {
    return key == "P" || key == "C" ? std::optional(LwnxTextKind::Save) : std::nullopt;
  }
  if (prefix == '$') {
    const auto kind = kind_of(key);
    return key.empty() ? std::optional(LwnxTextKind::Stop)
                       : (kind == LwnxTextKind::Distance ? kind : std::nullopt);
  }
  const auto kind = kind_of(key);
  return prefix == '#' && kind != LwnxTextKind::Baud ? std::nullopt : kind;
}

}  // namespace

std::optional<LwnxTextCommand> parse_text_command(std::string_view line) {
  if (line == "LD") {
    return LwnxTextCommand{LwnxTextKind::Distance, '?', "LD", std::nullopt};
  }
  if (line.empty() || std::string_view("?#$%").find(line.front()) == std::string_view::npos) {
    return std::nullopt;
  }
  LwnxTextCommand command;
  command.prefix = line.front();
  const std::size_t comma = std::min(line.find(','), line.size());
  command.key = changed(line.substr(1, comma - 1), std::toupper);
  if (comma < line.size()) {
    command.value = number_in(line.substr(comma + 1));
  }
  const auto kind = kind_with(command.prefix, command.key);
  if (!kind) {
    return std::nullopt;
  }
  command.kind = *kind;
  return command;
}

std::string text_answer(LwnxTextStyle style, const LwnxTextCommand& command, std::string_view value) {
  std::string answer;
  if (style == LwnxTextStyle::Sf11) {
    answer.append(1, command.prefix).append(command.key).append(1, ' ');
  } else {
    answer = changed(command.key, std::tolower);
    if (command.kind == LwnxTextKind::Distance && command.key != "L") {
      answer.append(1, ',').append(std::to_string(command.value.value_or(0)));
    }
    answer.append(1, ':');
  }
  return answer.append(value).append(kLineEnd);
}

std::string product_answer(const LwnxProduct& product) {
  const std::string end(kLineEnd);
  if (product.text_style == LwnxTextStyle::Sf11) {
    return "? " + product.text_name + " V7 Firmware: V1.0.0" + end;
  }
  return "p:" + product.text_name + ",1.0.0,11" + end;
}

std::string metres_text(double range_m) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", range_m);
  return text.data();
}

std::string legacy_distance(double range_m) {
  return metres_text(range_m).append(kLineEnd);
}

}  // namespace slamsensor::tools
