#pragma once

#include "firmware/config/sensor_config.hpp"
#include "tools/commands/command.hpp"
#include "tools/emulator/scenario.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// What of an emulated drive is recorded.
struct RecordDrive {
  Scenario scenario;
  firmware::Config config;  ///< of the sensor; its `head` is replaced by what the scenario's devices ask for
  std::filesystem::path out;           ///< replaced when it exists
  std::optional<std::uint32_t> scans;  ///< ended when so many are localised; 1 when neither is given ...
  std::optional<double> seconds;       ///< ... or after so much simulated time, whatever comes first
};

struct RecordSummary {
  std::uint32_t scans = 0;
  std::uint32_t fixes = 0;
  std::uint32_t scans_aborted = 0;
  std::uint64_t readings = 0;  ///< of the scans that ended
  std::uint64_t bytes = 0;     ///< of the recording
  std::uint64_t events = 0;
  std::uint64_t tape_chunks = 0;
  double simulated_s = 0.0;
  std::vector<TimedPose> truth;  ///< where the sensor stood, at the middle of each scan
  std::string faults;            ///< what happened to the head, as format_events has it
  std::string problem;           ///< what kept the head from scanning at the end; empty when nothing did
};

/// Called after each scan: scans made and wanted, or seconds where only those are limited.
using RecordProgress = std::function<void(std::uint32_t done, std::uint32_t total)>;

/// Records a drive of an emulated head in simulated time, as fast as the processor: a recording like that of
/// a live sensor (firmware/recording/recorder.hpp), with the tape, each pose, the landmarks of each scan and
/// its NMEA sentences. Its clock begins at 0 and is UTC too. The same arguments, the same file, bit for bit.
/// With `seconds` the stands change as the scenario says, else when a scan ends. When no scan ends in an hour
/// the drive is given up.
[[nodiscard]] tl::expected<RecordSummary, WorldError> record_drive(const RecordDrive& drive,
                                                                   const RecordProgress& progress = {});

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
