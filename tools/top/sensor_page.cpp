#include "tools/top/sensor_page.hpp"

#include "core/fix_names.hpp"
#include "firmware/supervision/status_parts.hpp"
#include "tools/output/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

using firmware::PoseMessage;
using firmware::StatusMessage;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<std::string_view, 2> kDeviceNames = {"pan-tilt   ", "rangefinder"};

std::string duration(std::int64_t ns) {
  return duration_text(hal::Stamp(ns));
}

std::string count(std::int64_t number, std::string_view one, std::string_view many) {
  return std::to_string(number) + ' ' + std::string(number == 1 ? one : many);
}

CellStyle style_of(firmware::SensorState state) {
  using enum firmware::SensorState;
  if (state == Fixed) {
    return CellStyle::Good;
  }
  return state == Faulted || state == Lost ? CellStyle::Bad : CellStyle::Warning;
}

void add_state(const StatusMessage& status, TextLines& lines) {
  const auto state = static_cast<firmware::SensorState>(status.state);
  std::string text = "state        " + std::string(firmware::to_string(state));
  if (static_cast<firmware::SourceMode>(status.source) == firmware::SourceMode::Emulated) {
    text += " (emulated)";
  }
  lines.push_back({text, style_of(state)});
  const bool fixed_once = status.time_to_first_fix_ns >= 0;
  lines.push_back(
      {"up           " + duration(status.uptime_ns) +
       (fixed_once ? ", first fix after " + duration(status.time_to_first_fix_ns) : ", no fix yet")});
}

std::string sigma_text(const std::array<double, 9>& covariance) {
  const double position_m = std::sqrt(covariance[0] + covariance[4]);
  const double heading_deg = std::sqrt(covariance[8]) / kDegree;
  return fixed_text(position_m, 3) + " m, " + fixed_text(heading_deg, 3) + " deg";
}

void add_place(const PoseMessage& pose, TextLines& lines) {
  const double turned_deg = core::wrap_angle(pose.heading_rad) / kDegree;
  const double heading_deg = turned_deg < 0.0 ? turned_deg + 360.0 : turned_deg;
  lines.push_back(
      {"  in map     " + std::to_string(pose.map) + (pose.map == pose.home ? ", home" : ", local")});
  lines.push_back(
      {"  x y        " + fixed_text(pose.x_m, 3) + " m, " + fixed_text(pose.y_m, 3) + " m", CellStyle::Bold});
  lines.push_back({"  heading    " + fixed_text(heading_deg, 2) + " deg", CellStyle::Bold});
  lines.push_back(
      {"  1 sigma    " + sigma_text(pose.covariance) + "; near " + sigma_text(pose.covariance_near)});
  lines.push_back({"  protection " + fixed_text(pose.protection_radius_m, 3) + " m"});
}

void add_pose(const SensorView& view, hal::Stamp now, TextLines& lines) {
  const PoseMessage& pose = *view.pose();
  const auto status = static_cast<core::FixStatus>(pose.status);
  const auto reason = static_cast<core::FixReason>(pose.reason);
  std::string text = "fix          " + std::string(core::to_string(status));
  if (reason != core::FixReason::None) {
    text += " (" + std::string(core::to_string(reason)) + ')';
  }
  text += ", scan " + std::to_string(pose.scan) + ", " + duration_text(now - view.pose_time()) + " ago";
  lines.push_back({text, status == core::FixStatus::Fix ? CellStyle::Good : CellStyle::Warning});
  if (core::has_pose(firmware::fix_of(pose))) {
    add_place(pose, lines);
  }
  std::string alarms;
  append_general(alarms, pose.expected_false_alarms, 3);
  lines.push_back({"  matches    " + std::to_string(pose.matches) + " of " +
                   std::to_string(pose.landmarks_seen) + " seen, expected false alarms " + alarms});
  lines.push_back({"  xi " + std::to_string(pose.error_xi) + ", W " + std::to_string(pose.weight_best) +
                   " over " + std::to_string(pose.weight_runner_up) + ", " +
                   count(pose.jumps, "jump", "jumps") + ", search " +
                   std::string(core::to_string(static_cast<core::SearchEnd>(pose.search_end)))});
}

void add_device(const StatusMessage& status, std::size_t i, TextLines& lines) {
  const auto state = static_cast<hal::DeviceState>(status.device_state[i]);
  std::string text = std::string(kDeviceNames[i]) + "  " + std::string(firmware::to_string(state));
  if (const auto model = firmware::text_of(status.device_model[i]); !model.empty()) {
    text += ", " + std::string(model);
  }
  if (status.device_recoveries[i] > 0) {
    text += ", back " + count(status.device_recoveries[i], "time", "times") + ", last in " +
            duration(status.device_last_recovery_ns[i]);
  }
  lines.push_back({text, state == hal::DeviceState::Ready ? CellStyle::Plain : CellStyle::Bad});
  if (const auto problem = firmware::text_of(status.device_problem[i]); !problem.empty()) {
    lines.push_back({"  " + std::string(problem), CellStyle::Warning});
  }
}

void add_head(const StatusMessage& status, TextLines& lines) {
  lines.push_back({"head         " + std::string(firmware::text_of(status.phase)) +
                   (status.held ? ", held" : "") + ", scan " + std::to_string(status.scan) + ", line " +
                   std::to_string(status.line) + " of " + std::to_string(status.lines)});
  if (const auto problem = firmware::text_of(status.problem); !problem.empty()) {
    lines.push_back({"  " + std::string(problem), CellStyle::Warning});
  }
  lines.push_back({"  pan tilt   " + fixed_text(status.pan_rad / kDegree, 2) + " deg, " +
                   fixed_text(status.tilt_rad / kDegree, 2) + " deg"});
  lines.push_back({"  readings   " + amount_text(status.readings_hz) + "/s, " +
                   amount_text(static_cast<double>(status.readings)) + " in all"});
  lines.push_back({"  latency    " + fixed_text(status.latency_s * 1e3, 2) + " ms +- " +
                   fixed_text(status.latency_sigma_s * 1e3, 2) + ", worst wake-up " +
                   duration(status.wake_latency_max_ns) + (status.realtime ? "" : ", not real-time")});
  for (std::size_t i = 0; i < firmware::kLcmDevices; ++i) {
    add_device(status, i, lines);
  }
}

void add_slam(const StatusMessage& status, TextLines& lines) {
  lines.push_back({"slam         " + count(status.fixes, "fix", "fixes") + " of " +
                   count(status.scans, "scan", "scans") + ", " +
                   count(status.hypotheses, "hypothesis", "hypotheses")});
  lines.push_back(
      {"  to the fix " + duration(status.process_last_ns) + ", worst " + duration(status.process_max_ns)});
  lines.push_back({"map          " + std::string(firmware::text_of(status.map_name)) + ", " +
                   count(status.landmarks, "landmark", "landmarks") + ", revision " +
                   std::to_string(status.map_revision) + (status.map_frozen ? ", frozen" : "")});
  if (status.local_maps > 0) {
    lines.push_back({"  and        " + count(status.local_maps, "local map", "local maps") + " with " +
                     count(status.local_landmarks, "landmark", "landmarks")});
  }
  const bool was_saved = status.map_saved_ago_ns >= 0;
  lines.push_back({"  " +
                       (was_saved ? "saved " + duration(status.map_saved_ago_ns) + " ago" : "never saved") +
                       (status.map_unsaved ? ", changed since" : ""),
                   status.map_unsaved && !was_saved ? CellStyle::Warning : CellStyle::Plain});
  if (status.recording) {
    lines.push_back({"recording", CellStyle::Good});
  }
}

}  // namespace

TextLines sensor_lines(const SensorView& view, hal::Stamp now) {
  TextLines lines;
  if (view.status()) {
    add_state(*view.status(), lines);
  } else {
    lines.push_back({"state        no status heard yet", CellStyle::Warning});
  }
  if (view.pose()) {
    add_pose(view, now, lines);
  } else {
    lines.push_back({"fix          none heard yet", CellStyle::Warning});
  }
  if (view.status()) {
    add_head(*view.status(), lines);
    add_slam(*view.status(), lines);
  }
  return lines;
}

TextLines counter_lines(const SensorView& view, hal::Stamp now) {
  constexpr hal::Stamp kRecent = std::chrono::seconds(10);
  TextLines lines;
  for (std::size_t station = 0; station < firmware::kLcmStationNames.size(); ++station) {
    const auto& counters = view.counters(static_cast<firmware::LcmStation>(station));
    const auto zeros =
        std::count_if(counters.begin(), counters.end(), [](const auto& c) { return c.value == 0; });
    lines.push_back({std::string(firmware::kLcmStationNames.at(station)) + "  (" +
                         std::to_string(counters.size()) + " counters, " + std::to_string(zeros) + " at 0)",
                     CellStyle::Bold});
    for (const SensorView::Counter& counter : counters) {
      if (counter.value != 0) {
        const bool is_recent = counter.changed != hal::Stamp::min() && now - counter.changed <= kRecent;
        std::string text = "  " + counter.name;
        text.resize(std::max<std::size_t>(text.size() + 1, 44), ' ');
        lines.push_back({text + std::to_string(counter.value) + (is_recent ? "  growing" : ""),
                         is_recent ? CellStyle::Warning : CellStyle::Plain});
      }
    }
  }
  return lines;
}

}  // namespace slamsensor::tools
