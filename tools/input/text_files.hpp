#pragma once

#include "core/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/reading.hpp"
#include "firmware/config/sensor_config.hpp"
#include "firmware/scan/scan_config.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/input/text.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A row of a landmark list.
struct LandmarkRow {
  std::int64_t scan = 0;
  core::Point2 position_L = core::Point2::Zero();  ///< m
  double diameter_m = 0.0;                         ///< 0 without a diameter column
  double weight = 1.0;                             ///< 1 without a weight column
};

/// A landmark list: rows by increasing scan, those of a scan in the order of the file.
struct LandmarkList {
  std::vector<LandmarkRow> rows;
  bool has_diameter = false;
  bool has_weight = false;
};

/// The list that `text` holds (`scan,x_m,y_m[,diameter_m[,weight]]`, columns in any order, the rows of a scan
/// anywhere), at least one row. An error, with the line, when a scan is not a whole number, a coordinate or
/// diameter is not a number within kInputReach_m, a weight or diameter is negative, or a column is missing,
/// unknown or there twice.
[[nodiscard]] tl::expected<LandmarkList, InputError> parse_landmark_csv(std::string_view text,
                                                                        std::string_view name);

/// An error when `config` orders or filters by a column that `list` has not. Without weights every row weighs
/// 1, so only a `weight_min` above 1 is refused.
[[nodiscard]] tl::expected<void, InputError> check_landmark_columns(
    const LandmarkList& list, std::string_view name, const firmware::LandmarkListConfig& config);

/// One scan of a list.
struct ListScan {
  std::vector<core::ScanLandmark> landmarks;  ///< heaviest first
  std::size_t beyond_max = 0;                 ///< left out: `detection.landmarks_max` is too small for them
  std::size_t at_one_place = 0;               ///< left out: within a millimetre of a heavier one
};

/// What is used of one scan's `rows`: those within `detection.range_max_m` that reach the minimums of
/// `config`, each place once, weighed by its order, heaviest first, ties in the order of the file; at most
/// `detection.landmarks_max`, of equal weights the nearest.
[[nodiscard]] ListScan select_landmarks(std::span<const LandmarkRow> rows,
                                        const firmware::LandmarkListConfig& config,
                                        const core::DetectionConfig& detection);

/// One scan of readings.
struct ReadingsScan {
  std::vector<std::vector<core::Reading>> scanlines;  ///< each in the order of the sweep
  std::size_t zero_ranges = 0;                        ///< of 0 m or less, taken for no return
  std::string remark;  ///< a line that says so when the rows are in no order of a sweep; else empty
};

/// The scan of a file of readings (`pan_deg,tilt_deg,range_m[,roll_deg,pitch_deg]` in any order; a range that
/// is empty, 0 or less is no return), in the order of the file: consecutive rows with the same text for a
/// tilt are one scanline. At least one reading. An error, with the line, for anything that is not a number,
/// pan beyond +-360 deg, tilt beyond +-90 deg, a range beyond kInputReach_m, a column missing, unknown or
/// twice, or a row of another width than the header.
///
/// Readings of a file with `roll_deg,pitch_deg` (core::Attitude, of the sensor) are levelled by them, those
/// of another by the fixed attitude of `levelling`; when that asks for an inclinometer, such a file is
/// refused.
[[nodiscard]] tl::expected<ReadingsScan, InputError> parse_readings_csv(
    std::string_view text, std::string_view name, const firmware::LevellingConfig& levelling = {});

/// A landmark of a map file.
struct MapPoint {
  std::int64_t id = 0;
  core::Point2 position_W = core::Point2::Zero();  ///< m
  std::optional<std::uint32_t> sightings;          ///< of a map that a sensor made
  double diameter_m = 0.0;                         ///< 0: not known
};

/// The landmarks of a map (`id,x_m,y_m[,sightings][,diameter_m]` in any order, further columns ignored), in
/// the order of the file, at least one. An error, with the line, when an id is not a whole number or occurs
/// twice, a coordinate is not a number within core::kLatticeReach_m, or a landmark was never seen.
[[nodiscard]] tl::expected<std::vector<MapPoint>, InputError> parse_map_csv(std::string_view text,
                                                                            std::string_view name);

/// parse_map_csv on a file.
[[nodiscard]] tl::expected<std::vector<MapPoint>, InputError> read_map_csv(const std::filesystem::path& path);

/// The trajectory that a text in the format of the TUM RGB-D benchmark holds (`t x y z qx qy qz qw` per line,
/// '#' comments), by increasing t; z is dropped and the heading is the yaw of the quaternion, which may be
/// off unit length by 1 %. A text without a pose is an empty trajectory. An error, with the line, when a line
/// has not eight finite numbers, a t occurs twice, or a quaternion is not a rotation or points straight up or
/// down.
[[nodiscard]] tl::expected<std::vector<TimedPose>, InputError> parse_tum(std::string_view text,
                                                                         std::string_view name);

/// parse_tum on a file.
[[nodiscard]] tl::expected<std::vector<TimedPose>, InputError> read_tum(const std::filesystem::path& path);

}  // namespace slamsensor::tools
