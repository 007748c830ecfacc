#pragma once

#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

enum class ScanFileKind : std::uint8_t { Cloud, Readings, Landmarks };

/// A file that holds scans.
struct ScanFile {
  std::filesystem::path path;
  ScanFileKind kind = ScanFileKind::Cloud;
};

/// What the inputs of a replay come to.
struct ScanFiles {
  std::vector<ScanFile> scans;                 ///< as the inputs were given; those of a folder by name
  std::vector<std::filesystem::path> ignored;  ///< .csv files of folders that hold no scans
};

/// What the header of a CSV says that it holds.
enum class CsvKind : std::uint8_t { Empty, Readings, Landmarks, Map, Other };

/// Told from the first line that is no comment: a column of readings, or `scan` with `x_m`, or a map's `id`
/// with `x_m`.
[[nodiscard]] CsvKind csv_kind(std::string_view text);

/// The last run of digits in the file's stem: 12 for "site2/scan_0012.pcd"; nothing without digits or when it
/// does not fit.
[[nodiscard]] std::optional<std::int64_t> scan_number(const std::filesystem::path& path);

/// The files that `inputs` (files and folders) name; sub-folders and hidden files of a folder are left alone.
/// An error when there is no input, one does not exist or cannot be read, a file is of no known kind, or a
/// folder holds no scan.
[[nodiscard]] tl::expected<ScanFiles, InputError> find_scan_files(
    std::span<const std::filesystem::path> inputs);

}  // namespace slamsensor::tools
