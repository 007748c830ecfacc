#pragma once

#include "core/fix.hpp"
#include "core/geometry/pose2.hpp"
#include "core/reading.hpp"
#include "firmware/store/map_file.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/output/text_output.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// What one scan gave, as the files of a replay hold it.
struct FixRow {
  std::int64_t scan = 0;  ///< the number in the file's name or the list's scan column
  double t_s = 0.0;       ///< time stamp in trajectory.tum
  core::Fix fix;
  std::optional<double> milliseconds;  ///< time the scan took to process, absent if it was not measured
};

/// Whether the measured times are written. Left out, the same scans give the same bytes on every run.
enum class MeasuredTimes : std::uint8_t { Written, Empty };

/// The whole of fixes.csv: a heading and a line per row, in the order given. Pose, sigmas (m, rad),
/// correlations and error_xi are empty without a fix; with an ambiguous one they belong to the better of the
/// two places. A sigma whose variance is negative or no number is empty, and so are its correlations.
/// `milliseconds` is the last column.
[[nodiscard]] std::string format_fixes(std::span<const FixRow> rows,
                                       MeasuredTimes times = MeasuredTimes::Written);

/// `path` holds `format_fixes(rows, times)`, or is as it was and the error says why.
[[nodiscard]] tl::expected<void, OutputError> write_fixes(const std::filesystem::path& path,
                                                          std::span<const FixRow> rows,
                                                          MeasuredTimes times = MeasuredTimes::Written);

/// The landmarks of one scan, heaviest first.
struct ScanRows {
  std::int64_t scan = 0;  ///< FixRow::scan
  std::vector<core::ScanLandmark> landmarks;
};

/// A landmark list, as a replay takes it: `scan,x_m,y_m,weight`, metres with 6 decimals.
[[nodiscard]] std::string format_landmarks(std::span<const ScanRows> scans);

/// A landmark of the map as map.csv holds it.
struct MapRow {
  std::uint64_t id = 0;
  core::Point2 position_W = core::Point2::Zero();  ///< m
  std::uint32_t xi = 0;                            ///< triangulations between it and the origin
  std::uint32_t sightings = 0;                     ///< scans that matched it, the one that found it included
  std::int64_t first_scan = 0;
  std::int64_t last_scan = 0;
  double sigma_m = 0.0;     ///< of its place in the map's frame, along each axis; 0: not known
  double diameter_m = 0.0;  ///< 0: not known
};

/// The whole of map.csv: the heading `id,x_m,y_m,xi,sightings,first_scan,last_scan,sigma_m,diameter_m` and a
/// line per row, in the order given, metres with 6 decimals.
[[nodiscard]] std::string format_map(std::span<const MapRow> rows);

/// `path` holds `format_map(rows)`, or is as it was and the error says why.
[[nodiscard]] tl::expected<void, OutputError> write_map(const std::filesystem::path& path,
                                                        std::span<const MapRow> rows);

/// The poses of the rows that are a fix in the home map of the last row, in their order; an ambiguous pose is
/// none.
[[nodiscard]] std::vector<TimedPose> trajectory_of(std::span<const FixRow> rows);

/// The whole of a trajectory in the format of the TUM RGB-D benchmark: a line `t x y z qx qy qz qw` per pose,
/// t in s as short as it reads back the same, metres with 6 decimals, the quaternion with 9 (its qw is never
/// negative).
[[nodiscard]] std::string format_trajectory(std::span<const TimedPose> poses);

/// `path` holds `format_trajectory(poses)`, or is as it was and the error says why.
[[nodiscard]] tl::expected<void, OutputError> write_trajectory(const std::filesystem::path& path,
                                                               std::span<const TimedPose> poses);

/// What a map file holds, a line per matter, for people: name, times, counts, extent, method, datum.
/// `bytes` is the size of the file.
[[nodiscard]] std::string map_info_text(const firmware::MapFile& map, std::size_t bytes);

/// Its landmarks as rows of map.csv.
[[nodiscard]] std::vector<MapRow> map_rows(const firmware::MapFile& map);

}  // namespace slamsensor::tools
