#pragma once

#include "tools/commands/command.hpp"
#include "tools/control/control_client.hpp"

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace slamsensor::tools {

enum class CtlForm : std::uint8_t { Text, Json };

struct CtlOptions {
  std::string socket = "/run/slamsensor/control";
  std::chrono::milliseconds timeout = std::chrono::seconds(60);  ///< for one answer
  CtlForm form = CtlForm::Text;
};

/// As one line of JSON: {"request", "ok", "code", "text", "lines"}, `code` null without an error.
[[nodiscard]] std::string answer_json(std::string_view request, const ControlAnswer& answer);

/// Sends `request` and prints the answer to `out`: the data lines and the text behind OK. With Json that is
/// one line: the daemon's own JSON for requests that have it (status, fix, counters, devices), else
/// answer_json. The exit status of a refused request is that of its code; its text is the error, or with Json
/// is printed as well.
[[nodiscard]] CommandResult run_request(ControlClient& client, std::string_view request,
                                        const CtlOptions& options, std::FILE* out);

/// Sends every line of `in` as a request, until its end or "quit", with a prompt when `in` is a terminal.
/// Refused requests are told on `out` and do not end it. The exit status is that of the last request.
[[nodiscard]] CommandResult run_lines(ControlClient& client, const CtlOptions& options, std::FILE* in,
                                      std::FILE* out);

}  // namespace slamsensor::tools
