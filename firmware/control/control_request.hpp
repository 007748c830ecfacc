#pragma once

#include "firmware/config/config.hpp"
#include "firmware/control/control_protocol.hpp"
#include "firmware/supervision/log.hpp"

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

enum class ReplyForm : std::uint8_t { Text, Json };

struct ControlVerb;
struct ControlContext;

/// A request that was understood. What its verb has no arguments for is at its default.
struct ControlRequest {
  const ControlVerb* verb = nullptr;
  ControlToken token = 0;
  ReplyForm form = ReplyForm::Text;
  std::string name;  ///< of a map or recording, a key, or the words of a request
  std::string value;
  Datum datum;
  ScanMode mode = ScanMode::Continuous;
  LogLevel level = LogLevel::Info;
};

/// Takes the arguments of a verb off the front of `text` and puts them into the request; what is left is too
/// much. The error says which argument is wrong and what is allowed.
using ArgumentParser = tl::expected<void, ControlError> (*)(std::string_view& text, ControlRequest& request);

// What may follow the words of a request.
tl::expected<void, ControlError> parse_nothing(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_json(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_words(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_name(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_optional_name(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_mode(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_datum(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_key(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_key_and_value(std::string_view& text, ControlRequest& request);
tl::expected<void, ControlError> parse_level(std::string_view& text, ControlRequest& request);

/// One request of the protocol: everything that is known of it.
struct ControlVerb {
  std::string_view words;
  std::string_view arguments;  ///< for people; in brackets what may be left out
  ArgumentParser parse;
  std::string_view description;  ///< one line
  ControlOutcome (*run)(const ControlRequest&, ControlContext&);

  /// "map load NAME"
  [[nodiscard]] std::string usage() const;
};

/// All requests, those of one kind together.
[[nodiscard]] std::span<const ControlVerb> control_verbs();

/// Carries a request out, on the thread that steps the ControlServer, and never waits: none when the server
/// is given the answer with the request's token later. Names are map_name_allowed, a datum lies in the ranges
/// of its settings, a key is one of settings().
using ControlHandler = std::function<ControlOutcome(const ControlRequest&)>;

/// Names of maps and recordings: 1 to 64 of A-Z a-z 0-9 _ -.
[[nodiscard]] bool map_name_allowed(std::string_view name) noexcept;

/// What `line`, without its end, asks for; or why it asks for nothing. The errors are Syntax, Unknown and
/// Value.
[[nodiscard]] tl::expected<ControlRequest, ControlError> parse_control_request(std::string_view line);

/// One aligned line per request whose words begin with `about`: words, arguments, what it is for. NotFound
/// when there is none.
[[nodiscard]] ControlResult control_help(std::string_view about);

/// `text` without blanks at both ends.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) noexcept {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t first = std::min(text.find_first_not_of(kBlanks), text.size());
  const std::size_t last = text.find_last_not_of(kBlanks);
  return last == text.npos ? std::string_view() : text.substr(first, last + 1 - first);
}

/// Takes the first word off `rest`, which keeps no blanks at its ends; empty when there is none.
[[nodiscard]] constexpr std::string_view take_word(std::string_view& rest) noexcept {
  rest = trimmed(rest);
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
  rest = trimmed(rest.substr(word.size()));
  return word;
}

}  // namespace slamsensor::firmware
