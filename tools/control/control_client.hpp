#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "tools/commands/command.hpp"

#include <tl/expected.hpp>

#include <chrono>
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

/// A connection to the daemon's control socket (firmware/control/control_protocol.hpp). Waits for answers.
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

}  // namespace slamsensor::tools
