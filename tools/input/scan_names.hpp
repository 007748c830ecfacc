#pragma once

#include "tools/input/text.hpp"

#include <tl/expected.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// What a file's name says about its scan.
struct ScanLabel {
  std::int64_t number = 0;
  std::chrono::nanoseconds time{};  ///< of the stamp in the name; without one the number stands for seconds
};

/// What the names of all files of a run say.
struct ScanLabels {
  std::vector<ScanLabel> labels;  ///< as the files were given; each number and each time occurs once
  std::string rule;               ///< which rule was taken, in one line
};

/// Numbers the scans of `files` by their names (the last part of the path without the extension):
/// - by time when every name holds a stamp: SECONDS.FRACTION or SECONDS_NANOSECONDS since 1970 (nine digits
///   of seconds or more; fractions may be padded or not), or milliseconds, microseconds or nanoseconds since
///   1970 in 13, 16 or 19 digits. The scans are numbered from 0 in the order of time. Beside names with
///   SECONDS.FRACTION one with as many digits of seconds and no fraction is a stamp, too.
/// - by time when every name holds another date and time of day, the year first: 2024-01-05T10:00:02.5,
///   2024-01-05_10-00-02, 20240105_100002_500, 20240105100002 (a fraction behind `_` or `-` has 3, 6 or 9
///   digits). It is taken for UTC, whatever zone stands behind it.
/// - by time when the names are alike but for one SECONDS.FRACTION of fewer digits, as simulators write: the
///   fraction is decimal when all have one length, or none of several digits ends in 0 (as a counter's 10).
/// - by the one number that differs, when the names are otherwise alike: 12 for frame_000012_os1.
/// - by all their numbers, leftmost first, when several differ: the leftmost when it occurs once in each
///   name, else the scans are numbered from 0 in that order.
/// - by the last number in the name when the names have different words.
/// - where these give two scans one number, or one none or one too large: by path as a person sorts it (s2
///   before s10), numbered from 0.
/// A single file needs no number and is then scan 0. An error when some names have stamps and others not, two
/// have the same stamp, two files have one path but for the extension, or names have different dates with the
/// year last (05-01-2024), in which nothing shows whether the day or the month comes first.
[[nodiscard]] tl::expected<ScanLabels, InputError> label_scans(std::span<const std::filesystem::path> files);

}  // namespace slamsensor::tools
