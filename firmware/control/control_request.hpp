#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/supervision/log.hpp"

#include <tl/expected.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::firmware {

// The control protocol: text lines over a local stream socket (setting control.socket).
//
// A request is one line: words between blanks, ended by a line feed (a carriage return before it is left
// out), at most kControlLineMax bytes. Empty lines and lines that begin with '#' are passed over. Requests
// may be sent ahead; they are answered in their order, one at a time, so a client that has shut down its
// sending side still gets every answer before the daemon closes the connection.
//
// An answer is any number of data lines, each of which begins with one blank that is not part of it, and then
// one line that begins with none:
//   OK [text]                     done; `text` says what
//   ERROR code: text              refused; `text` says why and what to do; nothing was changed
// where `code` is a name of kControlErrorNames. Text is UTF-8 without control characters.
//
//   request   status              request   map load shed
//   answer     state: fixed       answer    ERROR not_found: there is no map 'shed'; map list names those
//   that are
//              ...
//             OK
//
// `help` lists the requests (control_verbs). The socket may be used by who may write to it: mode 0660,
// group of its directory's setgid or else of the daemon. At most kControlClientsMax clients: of more, the one
// that has been silent longest has to go if it was silent for a second, else the new one gets `ERROR
// busy`.

/// Longest request, its line end not counted.
inline constexpr std::size_t kControlLineMax = 1024;
/// Longest answer with all its lines.
inline constexpr std::size_t kControlAnswerMax = std::size_t{1} << 20;
inline constexpr std::size_t kControlClientsMax = 16;

inline constexpr std::string_view kControlOk = "OK";
inline constexpr std::string_view kControlError = "ERROR";

/// Why a request was refused.
enum class ControlErrorCode : std::uint8_t {
  Syntax,    ///< no line of this protocol
  Unknown,   ///< no such request
  Value,     ///< an argument that is not allowed
  Config,    ///< the configuration would not be valid
  NotFound,  ///< what it names is not there
  Refused,   ///< not in the state that the sensor is in
  Failed,    ///< tried, and went wrong
  Busy,      ///< too much at once; later
  Timeout,   ///< no answer in time; it may still come to pass
};
inline constexpr std::array<std::string_view, 9> kControlErrorNames = {
    "syntax", "unknown", "value", "config", "not_found", "refused", "failed", "busy", "timeout"};

/// What a request brought.
struct ControlReply {
  std::string summary;             ///< behind OK; may be empty
  std::vector<std::string> lines;  ///< data; a line feed within one begins the next
};

/// Why it brought nothing: what, and what to do, in one line.
struct ControlError {
  ControlErrorCode code = ControlErrorCode::Failed;
  std::string message;
};

using ControlResult = tl::expected<ControlReply, ControlError>;

[[nodiscard]] inline tl::unexpected<ControlError> refusal(ControlErrorCode code, std::string text) {
  return tl::unexpected(ControlError{code, std::move(text)});
}

/// Stands for a request that is answered later. Never given twice.
using ControlToken = std::uint64_t;

/// The answer, or none: it will be given to ControlServer::complete with the token of the request.
using ControlOutcome = std::optional<ControlResult>;

/// As the protocol writes it, all lines with their ends. Control characters become '?'; an answer of more
/// than kControlAnswerMax bytes becomes an error that says so.
[[nodiscard]] std::string answer_text(const ControlResult& result);

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

/// One request of the protocol: everything about it.
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
