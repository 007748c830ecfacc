#include "firmware/control/control_request.hpp"

#include "firmware/config/suggestion.hpp"
#include "firmware/control/control_arguments.hpp"
#include "firmware/control/control_words.hpp"
#include "firmware/supervision/plain_text.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kEditsMax = 2;  // a word farther off is not taken for a slip

/// What follows `words` in `line`, blank by blank; none when it does not begin with them.
std::optional<std::string_view> after_words(std::string_view line, std::string_view words) {
  while (!words.empty()) {
    if (take_word(words) != take_word(line)) {
      return std::nullopt;
    }
  }
  return line;
}

/// "now, pause, resume or mode": what may follow the first word `group`.
std::string second_words(std::string_view group) {
  std::vector<std::string_view> seconds;
  for (const ControlCommand& command : control_commands()) {
    std::string_view rest = command.words;
    if (take_word(rest) == group && !rest.empty()) {
      seconds.push_back(rest);
    }
  }
  std::string text;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    text += i == 0 ? "" : i + 1 == seconds.size() ? " or " : ", ";
    text += seconds[i];
  }
  return text;
}

ControlError unknown(std::string_view line) {
  const std::string_view first = take_word(line);
  const std::string_view second = take_word(line);
  if (const std::string seconds = second_words(first); !seconds.empty()) {
    const std::string seen = second.empty() ? "nothing" : quoted(second);
    return {ControlErrorCode::Unknown,
            quoted(first) + " is followed by " + seconds + ", not by " + seen + "; help lists all requests"};
  }
  std::string message = "there is no request " + quoted(first);
  std::size_t least = std::min(kEditsMax, std::max<std::size_t>(first.size() / 3, 1)) + 1;
  std::string_view nearest;
  for (const ControlCommand& command : control_commands()) {
    std::string_view words = command.words;
    const std::string_view word = take_word(words);
    const bool is_near = first.size() <= word.size() + kEditsMax && word.size() <= first.size() + kEditsMax;
    const std::size_t edits = is_near ? edit_distance(first, word) : least;
    if (edits < least) {
      least = edits;
      nearest = word;
    }
  }
  if (!nearest.empty()) {
    message += "; did you mean " + quoted(nearest) + '?';
  }
  return {ControlErrorCode::Unknown, message + "; help lists all requests"};
}

ControlError misused(const ControlCommand& command, std::string_view problem) {
  std::string message(problem);
  message += "; say: " + std::string(command.words);
  if (!command.arguments_text.empty()) {
    message += ' ' + std::string(command.arguments_text);
  }
  return {ControlErrorCode::Value, std::move(message)};
}

bool needs_arguments(ControlArguments arguments) {
  return arguments != ControlArguments::None && arguments != ControlArguments::OptionalJson &&
         arguments != ControlArguments::OptionalCommand && arguments != ControlArguments::OptionalName;
}

tl::expected<ControlRequest, ControlError> parse_rest(const ControlCommand& command, std::string_view rest) {
  ControlRequest request;
  request.command = &command;
  if (rest.empty() && needs_arguments(command.arguments)) {
    return tl::unexpected(misused(command, "something is missing"));
  }
  if (const auto parsed = parse_arguments(rest, request); !parsed) {
    return tl::unexpected(parsed.error());
  }
  if (!rest.empty()) {
    return tl::unexpected(misused(command, "nothing is known of " + quoted(rest)));
  }
  if (command.arguments == ControlArguments::KeyValue && request.value.empty()) {
    return tl::unexpected(misused(command, "the value is missing"));
  }
  return request;
}

}  // namespace

tl::expected<ControlRequest, ControlError> parse_control_request(std::string_view line) {
  if (std::any_of(line.begin(), line.end(), [](char c) { return is_control(c) && c != '\t'; })) {
    return tl::unexpected(
        ControlError{ControlErrorCode::Syntax, "a control character; requests are lines of text"});
  }
  if (line.size() > kControlLineMax) {
    return tl::unexpected(ControlError{
        ControlErrorCode::Syntax,
        "the line is longer than " + std::to_string(kControlLineMax) + " bytes; send shorter ones"});
  }
  for (const ControlCommand& command : control_commands()) {
    if (const auto rest = after_words(line, command.words)) {
      return parse_rest(command, *rest);
    }
  }
  return tl::unexpected(unknown(line));
}

}  // namespace slamsensor::firmware
