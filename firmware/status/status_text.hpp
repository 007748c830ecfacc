#pragma once

#include "firmware/output/nmea.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/supervision/log.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// What the text and the JSON of a status have in common.

[[nodiscard]] constexpr std::string_view to_string(SensorState state) noexcept {
  return kSensorStateNames[static_cast<std::size_t>(state)];
}

[[nodiscard]] constexpr std::string_view to_string(hal::DeviceState state) noexcept {
  constexpr std::array<std::string_view, 4> kNames = {"absent", "starting", "ready", "faulted"};
  return kNames[static_cast<std::size_t>(state)];
}

[[nodiscard]] constexpr std::string_view to_string(SourceMode mode) noexcept {
  return mode == SourceMode::Live ? "live" : "emulated";
}

/// A device of the head with its name for machines and for people.
struct NamedDevice {
  std::string_view key;
  std::string_view title;
  const DeviceStatus* status;
};

[[nodiscard]] inline std::vector<NamedDevice> devices_of(const SensorStatus& status) {
  std::vector<NamedDevice> devices = {{"pan_tilt", "pan-tilt", &status.head.pan_tilt},
                                      {"rangefinder", "rangefinder", &status.head.rangefinder}};
  if (status.head.inclinometer) {
    devices.push_back({"inclinometer", "inclinometer", &*status.head.inclinometer});
  }
  return devices;
}

/// What keeps the head from scanning, if it is not what a device says of itself.
[[nodiscard]] inline std::string_view head_problem(const SensorStatus& status) {
  const std::string_view problem = status.head.problem.view();
  for (const NamedDevice& device : devices_of(status)) {
    if (device.status->problem.view() == problem) {
      return {};
    }
  }
  return problem;
}

struct NamedCounters {
  std::string_view key;
  const CounterTable* table;
};

[[nodiscard]] inline std::vector<NamedCounters> counters_of(const SensorStatus& status) {
  std::vector<NamedCounters> tables;
  for (const NamedDevice& device : devices_of(status)) {
    tables.push_back({device.key, &device.status->counters});
  }
  tables.push_back({"head", &status.head.counters});
  tables.push_back({"slam", &status.slam.counters});
  tables.push_back({"outputs", &status.outputs});
  return tables;
}

/// 1 sigma along the longest axis of the position's ellipse, m, and of the heading, rad.
struct PoseSigma {
  double position_m = 0.0;
  double heading_rad = 0.0;
};

/// None when `covariance`, one of a fix, is not usable.
[[nodiscard]] inline std::optional<PoseSigma> pose_sigma(const Eigen::Matrix3d& covariance) noexcept {
  if (!usable_covariance(covariance)) {
    return std::nullopt;
  }
  return PoseSigma{position_error(covariance.topLeftCorner<2, 2>()).major_m, std::sqrt(covariance(2, 2))};
}

/// ", 2 local maps with 31 landmarks"; empty when there is none.
[[nodiscard]] inline std::string local_maps_phrase(const SlamStatus& slam) {
  if (slam.local_maps == 0) {
    return {};
  }
  return ", " + std::to_string(slam.local_maps) +
         (slam.local_maps == 1 ? " local map with " : " local maps with ") +
         std::to_string(slam.local_landmarks) + " landmarks";
}

/// As below, with what stands in the way of the head where the reason is the head or its readings.
[[nodiscard]] std::string fix_phrase(const SensorStatus& status);

/// "fix x=12.34 m y=-5.60 m heading=87.1 deg, 23 of 30 landmarks", or why there is none.
[[nodiscard]] std::string fix_phrase(const core::Fix& fix);

/// What a home map that took the place of another means for latitude and longitude, and the way out.
[[nodiscard]] std::string replaced_home(const core::Fix& fix);

/// What systemctl status shows: the fix, the map, each device, what is in the way; one line.
[[nodiscard]] std::string status_line(const SensorStatus& status);

struct LogEntry {
  LogLevel level = LogLevel::Info;
  std::string text;
};

/// Finds in successive statuses what is worth a line of the log, each thing once when it comes to pass:
/// devices lost and recovered, problems, the fix found and lost, jumps, the map frozen, recordings.
class StatusLogger {
 public:
  /// What has changed since the status of the last call, or since nothing was known.
  [[nodiscard]] std::vector<LogEntry> compare(const SensorStatus& status);

 private:
  struct Device {
    hal::DeviceState state = hal::DeviceState::Absent;
    std::string problem;
    std::uint32_t recoveries = 0;
    bool was_ready = false;  // ever
  };

  void compare_device(Device& before, const NamedDevice& device, std::vector<LogEntry>& entries);
  void compare_head(const SensorStatus& status, std::vector<LogEntry>& entries);
  void compare_fix(const SensorStatus& status, std::vector<LogEntry>& entries);
  void compare_map(const SensorStatus& status, std::vector<LogEntry>& entries);

  std::array<Device, 3> devices_;
  std::string head_problem_;
  std::uint32_t stops_ = 0;
  hal::Stamp failure_due_{};  // when a head that goes on failing is reported again
  bool is_failing_ = false;
  SensorState state_ = SensorState::Starting;
  core::FixReason reason_ = core::FixReason::None;
  std::uint32_t jumps_ = 0;
  bool had_fix_ = false;  // ever
  bool is_held_ = false;
  bool is_recording_ = false;
  bool is_frozen_ = false;
};

}  // namespace slamsensor::firmware
