#pragma once

#include <cstdint>
#include <sysexits.h>

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

}  // namespace slamsensor::firmware
