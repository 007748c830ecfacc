#pragma once

#include "core/mapping/map_state.hpp"
#include "core/slam.hpp"
#include "firmware/config/sensor_config.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/input/scan_source.hpp"
#include "tools/input/text.hpp"
#include "tools/output/result_files.hpp"
#include "tools/recording/recording_file.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// What a run over recorded scans gave.
struct Replay {
  std::vector<FixRow> rows;         ///< one per scan that could be read, in order
  std::vector<ScanRows> landmarks;  ///< that the detector found, per row of a scan of readings
  std::vector<MapRow> map;          ///< the home map at the end
  std::vector<bool> matched;        ///< per landmark of `map`: by the last scan that has a fix
  std::vector<TimedPose> path;  ///< scans of the run that are in the home map at the end, as it then stands
  core::MapsSummary maps;       ///< at the end
  std::vector<std::string> refused;  ///< messages of the scans that could not be read
  std::vector<NotRead> not_read;     ///< entries of the input folders
  std::string order;                 ///< how the files' names gave the order of the scans; may be empty
  std::vector<std::string> notes;    ///< what else is to be known, as how a recording ended
  bool is_damaged = false;           ///< of a recording: not all of it could be played
  std::uint64_t fixes_compared = 0;  ///< of a recording: with those that were sent when it was made
  std::uint64_t fixes_alike = 0;     ///< of these, in everything, bit for bit
  core::Counters counters;
  LeftOut left_out;
  std::uint64_t points_skipped = 0;    ///< of clouds: without a direction (NaN, or the origin)
  std::uint64_t cells_dropped = 0;     ///< sightings beyond capacities.occupied_cells
  std::uint64_t readings_refused = 0;  ///< NaN, infinite or otherwise impossible
  std::uint64_t landmarks_evicted = 0;
  std::uint64_t path_thinnings = 0;
};

/// `first`, and then `second`, which began with a map of its own: its rows and notes follow, counts are
/// added, and the map is the second's; but one without any scan leaves the map of the first.
[[nodiscard]] Replay joined(Replay first, Replay second);

/// Whether the deadline of the profile (realtime.slam_deadline_s) cuts a search, as it does in the daemon.
enum class ReplayClock : std::uint8_t {
  Off,  ///< never: the same input gives the same bytes
  On,
};

/// Called after every scan; `total` scans in all.
using ReplayProgress = std::function<void(std::size_t done, std::size_t total, const FixRow& row)>;

/// Runs the scans of `inputs` (DESIGN 6), in the order of their times, through the pipeline with `config`.
/// A scan that cannot be read is refused and the run goes on; inputs that cannot be opened are an error.
/// Times are measured with the steady clock; everything else depends on the inputs alone.
[[nodiscard]] tl::expected<Replay, InputError> replay(const std::vector<std::filesystem::path>& inputs,
                                                      const firmware::Config& config,
                                                      const ReplayProgress& progress = {},
                                                      ReplayClock clock = ReplayClock::Off);

/// Does the run of `recording` again with `config`: its tape through drivers, scan head and pipeline; or,
/// where it has no tape, the landmarks of its scan messages through the pipeline. A scan's number is the one
/// that the sensor gave it, its time (UTC, s) the middle of the scan. Damage ends a tape and is noted: what
/// was good before it counts, and the scans after it are those of the scan messages beside the tape. Refused
/// when `config` does not fit the tape's devices.
[[nodiscard]] tl::expected<Replay, InputError> replay_recording(const RecordingFile& recording,
                                                                const firmware::Config& config,
                                                                const ReplayProgress& progress = {});

}  // namespace slamsensor::tools
