#pragma once

#include "tools/recording/recording_file.hpp"
#include "tools/replay/replay.hpp"

#include <tl/expected.hpp>

namespace slamsensor::tools {

/// Does the run of `recording` again with `config`: its tape through drivers, scan head and pipeline; or,
/// where it has no tape, the landmarks of its scan messages through the pipeline. A scan's number is the one
/// that the sensor gave it, its time (UTC, s) the middle of the scan. Damage ends a tape and is noted; what
/// was good before it counts. Refused when `config` does not fit the tape's devices.
[[nodiscard]] tl::expected<Replay, InputError> replay_recording(const RecordingFile& recording,
                                                                const firmware::Config& config,
                                                                const ReplayProgress& progress = {});

}  // namespace slamsensor::tools
