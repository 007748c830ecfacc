#pragma once

#include "core/geometry/pose2.hpp"

#include <Eigen/Core>

#include <chrono>
#include <cstdint>
#include <string_view>

namespace slamsensor::core {

/// When a scan was made. `utc` counts from 1970-01-01, `monotonic` from boot; a replayed list of scans has
/// its scan number, in seconds, in both.
struct ScanTime {
  std::chrono::nanoseconds start_utc{0};
  std::chrono::nanoseconds middle_utc{0};
  std::chrono::nanoseconds end_utc{0};
  std::chrono::nanoseconds end_monotonic{0};
};

enum class FixStatus : std::uint8_t { NoFix, Ambiguous, Fix };

/// Why a scan gave no fix.
enum class FixReason : std::uint8_t {
  None,             ///< it is a fix
  TooFewLandmarks,  ///< fewer landmarks than a pose can be believed from
  NoOverlap,        ///< no pose explains the scan better than chance does
  Symmetric,        ///< another place explains it about as well
  Deadline,         ///< the search was cut before anything believable was found
  Stale,            ///< no scan came in time
  Device,           ///< the sensor head is not working
  Moved,            ///< the carrier moved since or during the scan, so that the pose does not hold
  Timing,           ///< a device's timing is in doubt: what was measured when is not known well enough
  Copy,             ///< a copy of this place that was never mapped would explain it about as well
  LocalMap,         ///< known in a local map whose place in the home map is not known yet
  NoScan,           ///< no scan has been localised yet
};

/// How the search for the pose ended.
enum class SearchEnd : std::uint8_t { NotStarted, Complete, Share, Deadline };

/// The one answer that all outputs are written from (DESIGN 3). The pose is that of the body B in the frame W
/// of map number `map`. A fix is always one in the home map. Pose, covariances, `error_xi` and `map` mean
/// something when `status` is Fix, when it is Ambiguous (the better of the poses), and when `reason` is
/// LocalMap (the pose in the local map).
struct Fix {
  ScanTime time;
  std::uint32_t scan = 0;  ///< number of scans processed before this one
  FixStatus status = FixStatus::NoFix;
  FixReason reason = FixReason::NoScan;
  SearchEnd search_end = SearchEnd::NotStarted;
  std::uint32_t map = 0;   ///< number of the map, from 1 on; 0 when there is no pose
  std::uint32_t home = 0;  ///< number of the home map; 0 while there is none
  Pose2 pose_W;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();       ///< of (x m, y m, heading rad) in W, 1 sigma
                                                              ///< squared, drift since the origin included
  Eigen::Matrix3d covariance_near = Eigen::Matrix3d::Zero();  ///< the same relative to the landmarks about it
  double protection_radius_m = 0.0;  ///< the position's error exceeds it with at most the configured risk
  std::uint32_t error_xi = 0;        ///< triangulations between the scan and the origin
  std::uint32_t matches = 0;
  std::uint32_t landmarks_seen = 0;
  std::uint32_t landmarks_in_map = 0;
  double expected_false_alarms = 0.0;  ///< chance poses as good as this one to be expected in this search
  std::uint64_t weight_best = 0;       ///< W of the best hypothesis
  std::uint64_t weight_runner_up = 0;  ///< W of the second, 0 if there is none
  bool is_home_replaced = false;  ///< the home map took the place of another that had given fixes: what is
                                  ///< known of where that one lies on the earth does not hold
  std::uint32_t jumps = 0;        ///< how often the best hypothesis has changed to another history
};

/// Whether `fix` has a pose: its own, the better of two, or one in a local map.
[[nodiscard]] inline bool has_pose(const Fix& fix) noexcept {
  return fix.status != FixStatus::NoFix || fix.reason == FixReason::LocalMap;
}

/// The name of a status wherever it is written as text: `no_fix`, `ambiguous`, `fix`.
[[nodiscard]] constexpr std::string_view to_string(FixStatus status) noexcept {
  switch (status) {
    case FixStatus::NoFix:
      return "no_fix";
    case FixStatus::Ambiguous:
      return "ambiguous";
    case FixStatus::Fix:
      return "fix";
  }
  return "unknown";
}

/// The name of a reason wherever it is written as text; a fix has the reason `none`.
[[nodiscard]] constexpr std::string_view to_string(FixReason reason) noexcept {
  switch (reason) {
    case FixReason::None:
      return "none";
    case FixReason::TooFewLandmarks:
      return "too_few_landmarks";
    case FixReason::NoOverlap:
      return "no_overlap";
    case FixReason::Symmetric:
      return "symmetric";
    case FixReason::Copy:
      return "copy";
    case FixReason::LocalMap:
      return "local_map";
    case FixReason::Deadline:
      return "deadline";
    case FixReason::Stale:
      return "stale";
    case FixReason::Device:
      return "device";
    case FixReason::Moved:
      return "moved";
    case FixReason::Timing:
      return "timing";
    case FixReason::NoScan:
      return "no_scan";
  }
  return "unknown";
}

/// The name of how a search ended wherever it is written as text.
[[nodiscard]] constexpr std::string_view to_string(SearchEnd end) noexcept {
  switch (end) {
    case SearchEnd::NotStarted:
      return "not_started";
    case SearchEnd::Complete:
      return "complete";
    case SearchEnd::Share:
      return "share";
    case SearchEnd::Deadline:
      return "deadline";
  }
  return "unknown";
}

}  // namespace slamsensor::core
