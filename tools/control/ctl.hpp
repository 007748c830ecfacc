#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "tools/commands/command.hpp"

#include <tl/expected.hpp>

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// What the daemon answered to one request.
struct ControlAnswer {
  std::vector<std::string> lines;  ///< data
  bool is_ok = false;
  std::string code;     ///< of an error: a name of firmware::kControlErrorNames, or another that is newer
  std::string summary;  ///< behind OK, or the error's text
};

/// The exit status for a refused request (sysexits.h).
[[nodiscard]] int exit_status_of(std::string_view code);

/// A connection to the daemon's control socket (firmware/control/control_request.hpp). Waits for answers.
class ControlClient {
 public:
  /// The errors say whether the daemon is not there (EX_UNAVAILABLE) or the right is missing (EX_NOPERM).
  [[nodiscard]] static tl::expected<ControlClient, CommandError> connect(const std::string& socket);

  /// Sends one line and takes its whole answer, which has to come within `timeout`.
  [[nodiscard]] tl::expected<ControlAnswer, CommandError> ask(std::string_view request,
                                                              std::chrono::milliseconds timeout);

 private:
  using Deadline = std::chrono::steady_clock::time_point;

  ControlClient(firmware::FileDescriptor descriptor, std::string socket)
      : descriptor_(std::move(descriptor)), socket_(std::move(socket)) {}

  void send(std::string_view bytes, Deadline deadline);
  [[nodiscard]] tl::expected<std::string, CommandError> take_line(Deadline deadline);
  [[nodiscard]] tl::unexpected<CommandError> failure(int exit_status, std::string_view what) const;

  firmware::FileDescriptor descriptor_;
  std::string socket_;
  std::string input_;
};

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
/// Refused requests are reported on `out` and do not end it. The exit status is that of the last request.
[[nodiscard]] CommandResult run_lines(ControlClient& client, const CtlOptions& options, std::FILE* in,
                                      std::FILE* out);

}  // namespace slamsensor::tools
