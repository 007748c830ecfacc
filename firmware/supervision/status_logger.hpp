#pragma once

#include "firmware/status/sensor_status.hpp"
#include "firmware/supervision/log_level.hpp"
#include "firmware/supervision/status_parts.hpp"

#include <array>
#include <string>
#include <vector>

namespace slamsensor::firmware {

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
    bool was_ready = false;  // ever
  };

  void compare_device(Device& before, const NamedDevice& device, std::vector<LogEntry>& entries);
  void compare_head(const SensorStatus& status, std::vector<LogEntry>& entries);
  void compare_fix(const SensorStatus& status, std::vector<LogEntry>& entries);
  void compare_map(const SensorStatus& status, std::vector<LogEntry>& entries);

  std::array<Device, 3> devices_;
  std::string head_problem_;
  hal::Stamp failure_due_{};  // when a head that goes on failing is told again
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
