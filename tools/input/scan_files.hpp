#pragma once

#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

enum class ScanFileKind : std::uint8_t { Cloud, Readings, Landmarks };

/// A file that holds scans.
struct ScanFile {
  std::filesystem::path path;
  ScanFileKind kind = ScanFileKind::Cloud;
};

/// Whether what was not read may have been a scan that is missing now.
enum class NotReadKind : std::uint8_t {
  Companion,  ///< what lies beside scans: a truth, settings, a map, pictures, texts, hidden files
  Missed,     ///< anything else
};

/// An entry of a folder that is not read.
struct NotRead {
  std::filesystem::path path;
  std::string reason;
  NotReadKind kind = NotReadKind::Missed;
};

/// What the inputs of a replay come to.
struct ScanFiles {
  std::vector<ScanFile> scans;    ///< as the inputs were given; those of a folder by name
  std::vector<NotRead> not_read;  ///< all other entries of the folders, by name
};

/// What the header of a CSV says that it holds.
enum class CsvKind : std::uint8_t { Empty, Readings, Landmarks, Map, Other };

/// Told from the header, however its columns are parted and quoted: a column of readings, or `scan` with
/// `x_m`, or a map's `id` with `x_m`.
[[nodiscard]] CsvKind csv_kind(std::string_view text);

/// The files that `inputs` (files and folders) name. Every entry of a folder is either a scan or listed as
/// not read, with its reason. An error when there is no input, one does not exist or cannot be read, a file
/// is of no known kind, or a folder holds no scan.
[[nodiscard]] tl::expected<ScanFiles, InputError> find_scan_files(
    std::span<const std::filesystem::path> inputs);

}  // namespace slamsensor::tools
