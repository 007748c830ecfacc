#include "firmware/supervision/status_logger.hpp"

#include "firmware/supervision/decimal_text.hpp"
#include "firmware/supervision/status_line.hpp"
#include "firmware/supervision/status_parts.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kFailurePeriod = std::chrono::minutes(1);  // its figures change with each pass

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

std::vector<LogEntry> StatusLogger::compare(const SensorStatus& status) {
  std::vector<LogEntry> entries;
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
  const bool was_ready = before.state == hal::DeviceState::Ready;
  if (is_ready && !was_ready) {
    entries.push_back({LogLevel::Notice, before.was_ready
                                             ? title + " recovered after " + seconds(now.last_recovery)
                                             : title + " ready: " + std::string(now.model.view())});
  } else if (!is_ready && was_ready) {
    entries.push_back({LogLevel::Warning, with_problem(title + " lost", problem)});
  } else if (problem != before.problem && !problem.empty()) {
    entries.push_back({LogLevel::Warning, with_problem(title, problem)});
  }
  before.was_ready = before.was_ready || is_ready;
  before.state = now.state;
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
    entries.push_back({LogLevel::Warning, fix_phrase(fix)});
  }
  if (fix.jumps > jumps_) {
    entries.push_back({LogLevel::Warning,
                       "the best hypothesis changed to another history; poses before and after "
                       "differ in more than motion"});
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
