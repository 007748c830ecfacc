#pragma once

#include "tools/commands/command.hpp"

#include <cstdio>
#include <optional>
#include <string>

namespace slamsensor::tools {

/// A recording that the running daemon makes.
struct LiveRecording {
  std::string socket;             ///< of the daemon
  std::string name;               ///< of the recording; empty: one that the daemon makes of the time
  std::optional<double> seconds;  ///< how long; else until SIGINT, SIGTERM or SIGHUP
};

/// Has the daemon begin a recording, waits, has it end it; the daemon's answers go to `out`. The recording is
/// in the daemon's folder (record.directory). The named signals are blocked from then on.
[[nodiscard]] CommandResult record_live(const LiveRecording& recording, std::FILE* out);

}  // namespace slamsensor::tools
