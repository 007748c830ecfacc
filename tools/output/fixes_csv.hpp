#pragma once

#include "core/fix.hpp"
#include "tools/output/write_file.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

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

}  // namespace slamsensor::tools
