#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <csignal>
#include <cstdint>
#include <optional>
#include <sysexits.h>
#include <vector>

namespace slamsensor::firmware {

/// Why the daemon ended.
enum class ExitReason : std::uint8_t {
  Ordered,        ///< stopped by a signal
  Usage,          ///< the command line is wrong
  Config,         ///< the configuration is wrong; starting again changes nothing
  NoPermission,   ///< a right is missing (real time required, memory lock)
  Unavailable,    ///< something that it cannot do without is not there or taken (control socket)
  NoResources,    ///< the system had no memory, thread or descriptor
  ThreadStalled,  ///< a thread made no progress any more
  Fault,          ///< a fault of the program
};

/// The exit status for it (sysexits.h). systemd must not restart after Usage and Config
/// (RestartPreventExitStatus).
[[nodiscard]] constexpr int exit_status(ExitReason reason) noexcept {
  switch (reason) {
    case ExitReason::Ordered:
      return EX_OK;
    case ExitReason::Usage:
      return EX_USAGE;
    case ExitReason::Config:
      return EX_CONFIG;
    case ExitReason::NoPermission:
      return EX_NOPERM;
    case ExitReason::Unavailable:
      return EX_UNAVAILABLE;
    case ExitReason::NoResources:
      return EX_OSERR;
    case ExitReason::ThreadStalled:
    case ExitReason::Fault:
      break;
  }
  return EX_SOFTWARE;
}

/// What a signal asks of the daemon.
enum class Order : std::uint8_t {
  Stop,     ///< SIGTERM, SIGINT, SIGQUIT, SIGPWR, SIGXCPU
  Reload,   ///< SIGHUP
  SaveMap,  ///< SIGUSR1
};

/// The daemon's signals as something to poll. While one lives, the signals of Order are blocked in the thread
/// that made it and in all that this starts afterwards, and every other signal that would end the process and
/// is no fault of the program is ignored: none ends the daemon without a last save.
class Signals {
 public:
  /// Before any other thread is started.
  [[nodiscard]] static tl::expected<Signals, hal::InitError> create();

  Signals(Signals&& other) noexcept = default;
  Signals& operator=(Signals&& other) = delete;
  ~Signals();

  /// Readable when there is an order.
  [[nodiscard]] int fd() const noexcept { return descriptor_.get(); }
  /// The next order; none when there is none. Never waits.
  [[nodiscard]] std::optional<Order> take() noexcept;

 private:
  Signals() = default;
  void ignore_others();

  FileDescriptor descriptor_;
  sigset_t mask_before_{};
  std::vector<struct sigaction> before_;  // of the signals that are ignored
};

}  // namespace slamsensor::firmware
