#include "firmware/status/status_text.hpp"

#include "core/config.hpp"
#include "core/fix.hpp"
#include "firmware/supervision/log.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kFailurePeriod = std::chrono::minutes(1);  // its figures change with each pass

/// What a reason means for who reads it.
std::string_view meaning(core::FixReason reason) {
  switch (reason) {
    case core::FixReason::TooFewLandmarks:
      return "too few landmarks around";
    case core::FixReason::NoOverlap:
      return "nothing here looks like the map";
    case core::FixReason::Symmetric:
      return "another place of the map looks the same";
    case core::FixReason::Deadline:
      return "the search was cut before its end (realtime.slam_deadline_s, association.effort_max)";
    case core::FixReason::Stale:
      return "the last scan is too old";
    case core::FixReason::Device:
      return "the sensor head is not working";
    case core::FixReason::Moved:
      return "the carrier moved";
    case core::FixReason::Timing:
      return "the timing of a device is in doubt";
    case core::FixReason::Copy:
      return "a copy of this place that is not in the map would look the same (acceptance.copy_size_m)";
    case core::FixReason::LocalMap:
      return "known in a local map, whose place in the home map is not known yet";
    case core::FixReason::NoScan:
      return "no scan yet";
    case core::FixReason::None:
      break;
  }
  return to_string(reason);
}

std::string why_none(const core::Fix& fix) {
  if (fix.reason == core::FixReason::NoScan || fix.reason == core::FixReason::Device) {
    return std::string(meaning(fix.reason));
  }
  return std::string(meaning(fix.reason)) + ", " + std::to_string(fix.landmarks_seen) + " landmarks seen";
}

std::string fix_clause(const SensorStatus& status) {
  const core::Fix& fix = status.report.fix;
  switch (status.state) {
    case SensorState::Fixed:
      return ' ' + fix_phrase(fix);
    case SensorState::Ambiguous:
    case SensorState::Lost:
      return ": " + why_none(fix);
    default:
      return status.slam.scans == 0 ? std::string() : ", " + fix_phrase(fix);
  }
}

std::string device_phrase(const NamedDevice& device) {
  std::string text(device.title);
  if (device.status->problem.view().empty()) {
    return text + ' ' + std::string(to_string(device.status->state));
  }
  return text + ": " + std::string(device.status->problem.view());
}

std::string map_phrase(const SensorStatus& status) {
  return "map '" + std::string(status.map_name.view()) + "' " + std::to_string(status.slam.landmarks) +
         " landmarks" + (status.slam.frozen ? " (frozen)" : "");
}

std::string seconds(hal::Stamp time) {
  return decimal_text(hal::to_seconds(time), 1) + " s";
}

std::string with_problem(std::string text, std::string_view problem) {
  return problem.empty() ? text : text + ": " + std::string(problem);
}

/// How a fix that there was comes to an end.
bool is_without_fix(SensorState state) {
  return state == SensorState::Lost || state == SensorState::Ambiguous;
}

}  // namespace

std::string fix_phrase(const core::Fix& fix) {
  const std::string landmarks =
      std::to_string(fix.matches) + " of " + std::to_string(fix.landmarks_seen) + " landmarks";
  if (fix.status == core::FixStatus::Fix) {
    return "x=" + decimal_text(fix.pose_W.x_m, 2) + " m y=" + decimal_text(fix.pose_W.y_m, 2) +
           " m heading=" + decimal_text(fix.pose_W.heading_rad / core::kDegree, 1) + " deg, " + landmarks;
  }
  return std::string(fix.status == core::FixStatus::Ambiguous ? "ambiguous" : "no fix") + ": " +
         why_none(fix);
}

std::string fix_phrase(const SensorStatus& status) {
  const core::Fix& fix = status.report.fix;
  if (status.state == SensorState::Held) {
    return with_problem("no fix: scanning is held", status.head.problem.view());
  }
  const bool is_of_head =
      fix.status != core::FixStatus::Fix &&
      (fix.reason == core::FixReason::Device || fix.reason == core::FixReason::TooFewLandmarks);
  return with_problem(fix_phrase(fix), is_of_head ? status.head.problem.view() : std::string_view());
}

std::string replaced_home(const core::Fix& fix) {
  return "the home map was replaced by map " + std::to_string(fix.home) +
         ", for which the datum does not hold: no latitude and longitude until a map is loaded, or 'map "
         "reset' "
         "where the datum holds";
}

std::string status_line(const SensorStatus& status) {
  std::string text = std::string(to_string(status.state)) + fix_clause(status) + ", " + map_phrase(status);
  for (const NamedDevice& device : devices_of(status)) {
    text += "; " + device_phrase(device);
  }
  if (const std::string_view problem = head_problem(status); !problem.empty()) {
    text += "; " + std::string(problem);
  }
  return plain_text(text);
}

std::vector<LogEntry> StatusLogger::compare(const SensorStatus& status) {
  std::vector<LogEntry> entries;
  if (status.head.stops != stops_) {
    stops_ = status.head.stops;
    entries.push_back({LogLevel::Warning,
                       "this process was stopped for " + seconds(status.head.last_stop) +
                           " (a gap in its own clock: a stop signal, a debugger, a suspended machine, no "
                           "processor time); nobody listened to the devices meanwhile"});
  }
  const std::vector<NamedDevice> devices = devices_of(status);
  for (std::size_t i = 0; i < std::min(devices.size(), devices_.size()); ++i) {
    compare_device(devices_[i], devices[i], entries);
  }
  compare_head(status, entries);
  compare_fix(status, entries);
  compare_map(status, entries);
  return entries;
}

void StatusLogger::compare_device(Device& before, const NamedDevice& device, std::vector<LogEntry>& entries) {
  const DeviceStatus& now = *device.status;
  const std::string_view problem = now.problem.view();
  const std::string title(device.title);
  const bool is_ready = now.state == hal::DeviceState::Ready;
  bool was_ready = before.state == hal::DeviceState::Ready;
  if (was_ready && (!is_ready || now.recoveries != before.recoveries)) {  // it may have been back at once
    entries.push_back({LogLevel::Warning, with_problem(title + " lost", now.last_loss.view())});
    before.problem = now.last_loss.view();
    was_ready = false;
  }
  if (is_ready && !was_ready) {
    entries.push_back({LogLevel::Notice, before.was_ready
                                             ? title + " recovered after " + seconds(now.last_recovery)
                                             : title + " ready: " + std::string(now.model.view())});
  } else if (problem != before.problem && !problem.empty()) {
    entries.push_back({LogLevel::Warning, with_problem(title, problem)});
  }
  before.was_ready = before.was_ready || is_ready;
  before.state = now.state;
  before.recoveries = now.recoveries;
  before.problem = problem;
}

void StatusLogger::compare_head(const SensorStatus& status, std::vector<LogEntry>& entries) {
  const HeadStatus& head = status.head;
  const std::string_view problem = head_problem(status);
  if (head.held != is_held_) {
    entries.push_back(head.held ? LogEntry{LogLevel::Notice, with_problem("scanning is held", problem)}
                                : LogEntry{LogLevel::Notice, "scanning goes on"});
  } else if (head.failing && !head.held) {
    if (!is_failing_ || head.stamp >= failure_due_) {
      entries.push_back({LogLevel::Warning, with_problem("no scan comes about", problem)});
      failure_due_ = head.stamp + kFailurePeriod;
    }
  } else if (problem != head_problem_ && !problem.empty() && !head.held) {
    entries.push_back(
        {LogLevel::Warning, with_problem(head.phase == "waiting" ? "no scanning" : "sensor head", problem)});
  } else if (is_failing_ && problem.empty()) {
    entries.push_back({LogLevel::Notice, "scans come about again"});
  }
  is_failing_ = head.failing && !head.held;
  is_held_ = head.held;
  head_problem_ = problem;
}

void StatusLogger::compare_fix(const SensorStatus& status, std::vector<LogEntry>& entries) {
  const core::Fix& fix = status.report.fix;
  const bool is_new_reason = status.state != state_ || fix.reason != reason_;
  if (status.state == SensorState::Fixed && state_ != SensorState::Fixed) {
    std::string text = (had_fix_ ? "fix found again: " : "first fix: ") + fix_phrase(fix);
    if (!had_fix_ && status.report.time_to_first_fix) {
      text += ", " + seconds(*status.report.time_to_first_fix) + " after start";
    }
    entries.push_back({LogLevel::Notice, text});
    had_fix_ = true;
  } else if (is_without_fix(status.state) && is_new_reason) {
    entries.push_back({LogLevel::Warning, fix_phrase(status)});
  }
  if (fix.jumps > jumps_) {
    entries.push_back({LogLevel::Warning,
                       "the best hypothesis changed to another history; poses before and after "
                       "differ in more than motion"});
    if (fix.is_home_replaced) {
      entries.push_back({LogLevel::Warning, replaced_home(fix)});
    }
  }
  jumps_ = fix.jumps;
  state_ = status.state;
  reason_ = fix.reason;
}

void StatusLogger::compare_map(const SensorStatus& status, std::vector<LogEntry>& entries) {
  if (status.slam.frozen != is_frozen_) {
    entries.push_back({LogLevel::Notice, status.slam.frozen ? "the map is frozen" : "the map may grow"});
  }
  if (status.recording != is_recording_) {
    entries.push_back({LogLevel::Notice, status.recording ? "recording begins" : "recording has ended"});
  }
  is_frozen_ = status.slam.frozen;
  is_recording_ = status.recording;
}

}  // namespace slamsensor::firmware
