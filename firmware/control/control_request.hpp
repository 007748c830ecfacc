#pragma once

#include "firmware/control/control_target.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// What may follow the words of a request.
enum class ControlArguments : std::uint8_t {
  None,
  OptionalJson,     ///< "json"
  OptionalCommand,  ///< words of a request
  Name,
  OptionalName,
  Mode,      ///< "continuous" or "single"
  Datum,     ///< latitude, longitude, height, bearing
  Key,       ///< of settings()
  KeyValue,  ///< a key, and the rest of the line
  Level,     ///< of kLogLevelNames
};

enum class ReplyForm : std::uint8_t { Text, Json };

struct ControlCommand;

/// A request that was understood. The arguments that its command does not have are at their defaults.
struct ControlRequest {
  const ControlCommand* command = nullptr;
  ReplyForm form = ReplyForm::Text;
  std::string name;  ///< of a map or recording, a key, or the words of a request
  std::string value;
  Datum datum;
  ScanMode mode = ScanMode::Continuous;
  LogLevel level = LogLevel::Info;
};

/// One request of the protocol. Everything that is known of it is in the table of these.
struct ControlCommand {
  std::string_view words;
  ControlArguments arguments;
  std::string_view arguments_text;  ///< for people
  std::string_view description;     ///< one line
  ControlOutcome (*run)(const ControlRequest&, ControlToken, ControlTarget&);
};

/// All requests, those of one kind together.
[[nodiscard]] std::span<const ControlCommand> control_commands();

/// Names of maps and recordings: 1 to 64 of A-Z a-z 0-9 _ -.
[[nodiscard]] bool map_name_allowed(std::string_view name) noexcept;

/// What `line`, without its end, asks for; or why it asks for nothing. The errors are Syntax, Unknown and
/// Value.
[[nodiscard]] tl::expected<ControlRequest, ControlError> parse_control_request(std::string_view line);

/// One aligned line per request whose words begin with `about`: words, arguments, what it is for. NotFound
/// when there is none.
[[nodiscard]] ControlResult control_help(std::string_view about);

}  // namespace slamsensor::firmware
