#pragma once

#include "core/reading.hpp"
#include "firmware/config/sensor_config.hpp"
#include "tools/input/scan_source.hpp"
#include "tools/input/text.hpp"

#include <tl/expected.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A scan's number may be its time in seconds (core::ScanTime); larger ones do not fit its nanoseconds.
inline constexpr std::int64_t kScanNumberMax = 9'000'000'000;

/// A coordinate or range beyond this comes from a broken file, not from a rangefinder.
inline constexpr double kInputReach_m = 10'000.0;

/// One scan as an input file holds it: scanlines of readings, or landmarks that were found elsewhere.
struct InputScan {
  std::int64_t number = 0;          ///< from the file's name, or the list's scan column
  std::chrono::nanoseconds time{};  ///< the stamp in the file's name; without one the number in seconds
  std::string name;                 ///< for messages: "campus/scan_001.pcd", "landmarks.csv: scan 7"
  bool is_landmark_list = false;
  std::vector<std::vector<core::Reading>> scanlines;  ///< each in the order of the sweep
  std::vector<core::ScanLandmark> landmarks;
  std::size_t points_skipped = 0;          ///< of a cloud: without direction (a coordinate NaN, or all zero)
  std::size_t landmarks_beyond_max = 0;    ///< of a list: left out (detection.landmarks_max)
  std::size_t landmarks_at_one_place = 0;  ///< of a list: left out, each place counts once
  std::size_t zero_ranges = 0;  ///< of readings: 0 or less, which many devices write when nothing came back
  std::string remark;           ///< what of its file was not read, or is doubtful; empty when nothing is
};

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
enum class CsvKind : std::uint8_t { Empty, Readings, Landmarks, Map, Fixes, Other };

/// Found from the header, however its columns are parted and quoted: a column of readings, or `scan` with
/// `x_m`, or a map's `id` with `x_m`, or, with `status` beside `scan`, the fixes that replay and locate
/// write.
[[nodiscard]] CsvKind csv_kind(std::string_view text);

/// The files that `inputs` (files and folders) name. Every entry of a folder is either a scan or listed as
/// not read, with its reason. An error when there is no input, one does not exist or cannot be read, a file
/// is of no known kind, or a folder holds no scan.
[[nodiscard]] tl::expected<ScanFiles, InputError> find_scan_files(
    std::span<const std::filesystem::path> inputs);

/// The scans of one or more inputs, in the order of their times, one at a time: a cloud or a file of readings
/// is in memory only while it is handed out. One thread.
class ScanSource {
 public:
  ScanSource() = default;
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;
  virtual ~ScanSource() = default;

  /// How many scans there are in all, known before the first is loaded.
  [[nodiscard]] virtual std::size_t count() const = 0;

  /// The next scan, or nothing after the last. An error concerns this scan alone: the call after it goes on
  /// with the one that follows.
  [[nodiscard]] virtual tl::expected<std::optional<InputScan>, InputError> next() = 0;

  /// The entries of the given folders that are not read, and why.
  [[nodiscard]] virtual std::span<const NotRead> not_read() const = 0;

  /// How the names of the files gave the order of the scans, in one line; empty where no order was needed.
  [[nodiscard]] virtual const std::string& order() const = 0;
};

/// Opens what `slamsensor replay` takes (DESIGN 6): files, or folders of files, of point clouds (.pcd),
/// readings (.csv) and landmark lists (.csv; the kind is found from the header). A scan's number and time
/// come from its file's name (label_scans), or from the list's scan column. An error when a path does not
/// exist, a folder holds no scan, a number is missing or taken twice, a landmark list has not the columns
/// that `config` asks for, or a step in `config` is not positive. A landmark list that cannot be read is one
/// scan, the first, that is an error.
[[nodiscard]] tl::expected<std::unique_ptr<ScanSource>, InputError> open_scans(
    std::span<const std::filesystem::path> inputs, const firmware::Config& config);

/// What scans held that was not used, counted over a run.
struct LeftOut {
  std::uint64_t landmarks_beyond_max = 0;  ///< of lists longer than detection.landmarks_max
  std::uint64_t scans_beyond_max = 0;      ///< those lists
  std::size_t landmarks_most = 0;          ///< in the longest of them
  std::uint64_t landmarks_at_one_place = 0;
  std::uint64_t zero_ranges = 0;  ///< readings of 0 m or less

  void see(const InputScan& scan);
  /// A list of which `used` landmarks were used and `beyond_max` were too many.
  void see_list(std::size_t used, std::size_t beyond_max);
  void add(const LeftOut& other);

  /// For a summary: a line per kind, each with its number and what can be done; empty when nothing was left
  /// out.
  [[nodiscard]] std::string text() const;
};

}  // namespace slamsensor::tools
