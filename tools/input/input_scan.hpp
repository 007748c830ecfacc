#pragma once

#include "core/landmark.hpp"
#include "core/reading.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
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
  std::size_t points_skipped = 0;  ///< of a cloud: without direction (a coordinate NaN, or all zero)
  std::string remark;              ///< one line on what of its file was not read; empty when all was
};

}  // namespace slamsensor::tools
