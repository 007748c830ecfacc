#include "tools/emulator/ptu/ascii_command.hpp"

#include "tools/emulator/ptu/ascii_handlers.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

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

char capital(char c) {
  return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
}

bool is_letter(char c) {
  return (c >= 'A' && c <= 'Z') || c == '@' || c == '_' || c == '?';
}

}  // namespace

std::optional<long> AsciiCommand::number() const {
  return to_number(argument);
}

std::optional<std::vector<long>> AsciiCommand::numbers() const {
  std::vector<long> found;
  for (std::size_t begin = 0; begin <= argument.size();) {
    const std::size_t end = std::min(argument.find(',', begin), argument.size());
    const auto value = to_number(std::string_view(argument).substr(begin, end - begin));
    if (!value) {
      return std::nullopt;
    }
    found.push_back(*value);
    begin = end + 1;
  }
  return found;
}

AsciiCommand parse_ascii(std::string_view text) {
  std::string capitals(text);
  std::transform(capitals.begin(), capitals.end(), capitals.begin(), capital);
  const auto end = std::find_if_not(capitals.begin(), capitals.end(), is_letter);
  return {std::string(capitals.begin(), end), std::string(end, capitals.end())};
}

PtuAnswer obey_ascii(PtuUnit& unit, std::string_view text, Stamp now) {
  const AsciiCommand command = parse_ascii(text);
  const AsciiCall call{unit, command, now};
  const PtuSeries series = unit.settings.model.series;
  if (const AsciiHandler handler = find_handler(command.letters, series)) {
    return handler(call);
  }
  // Letters that go on after a command of two or more are taken for its argument.
  for (std::size_t size = command.letters.size(); size > 2; --size) {
    if (find_handler(std::string_view(command.letters).substr(0, size - 1), series) != nullptr) {
      return call.illegal();
    }
  }
  return call.error(unit.settings.wording.illegal_command);
}

AsciiHandler find_handler(std::string_view letters, PtuSeries series) {
  if (const AsciiHandler handler = find_axis_handler(letters, series)) {
    return handler;
  }
  const AsciiHandler handler = find_mode_handler(letters, series);
  return handler != nullptr ? handler : find_unit_handler(letters, series);
}

PtuAnswer AsciiCall::ok() const {
  return {.bytes = "*" + unit.settings.line_end};
}

PtuAnswer AsciiCall::text(std::string_view words) const {
  return {.bytes = "* " + std::string(words) + unit.settings.line_end};
}

PtuAnswer AsciiCall::text(std::string_view words, std::string_view terse) const {
  return text(unit.head.config.feedback == PtuFeedback::Verbose ? words : terse);
}

PtuAnswer AsciiCall::error(std::string_view words) const {
  return {.bytes = "! " + std::string(words) + unit.settings.line_end};
}

PtuAnswer AsciiCall::illegal() const {
  return error(unit.settings.wording.illegal_argument);
}

PtuAnswer AsciiCall::judged(const PtuVerdict& verdict) const {
  return verdict.status == PtuStatus::Ok ? ok() : error(verdict.error);
}

}  // namespace slamsensor::tools
