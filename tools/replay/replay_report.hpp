#pragma once

#include "firmware/config/sensor_config.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/output/text_output.hpp"
#include "tools/replay/replay.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// The files that write_replay makes in `folder`.
[[nodiscard]] std::vector<std::filesystem::path> replay_files(const std::filesystem::path& folder);

/// Writes trajectory.tum, hindsight.tum, fixes.csv, map.csv, track.nmea and plot.svg (DESIGN 6) into
/// `folder`, which is made if need be. The same replay gives the same bytes; the measured times in fixes.csv
/// are the one exception, and `times` leaves them out. `evaluation` brings the truth into the map frame for
/// the picture.
[[nodiscard]] tl::expected<void, OutputError> write_replay(
    const Replay& replay, const firmware::Config& config, std::span<const TimedPose> truth,
    const std::optional<Evaluation>& evaluation, MeasuredTimes times, const std::filesystem::path& folder);

/// Whether something that may have been a scan was not replayed: refused, damaged or not read.
[[nodiscard]] bool is_incomplete(const Replay& replay);

/// What happened, for people: scans, how they were ordered, what was not read, fixes, reasons, map, times,
/// and every counter that is not zero.
[[nodiscard]] std::string replay_summary(const Replay& replay);

}  // namespace slamsensor::tools
