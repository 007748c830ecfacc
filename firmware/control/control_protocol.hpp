#pragma once

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
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
// that has been silent longest has to go if it was silent for a second, else the new one is told `ERROR
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

}  // namespace slamsensor::firmware
