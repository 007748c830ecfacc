#pragma once

#include "core/config.hpp"
#include "core/landmark.hpp"
#include "firmware/config/config.hpp"
#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
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

/// What is used of one scan's `rows`: those within `detection.range_max_m` that reach the minimums of
/// `config`, weighed by its order, heaviest first, ties in the order of the file, at most
/// `detection.landmarks_max`.
[[nodiscard]] std::vector<core::ScanLandmark> select_landmarks(std::span<const LandmarkRow> rows,
                                                               const firmware::LandmarkListConfig& config,
                                                               const core::DetectionConfig& detection);

}  // namespace slamsensor::tools
