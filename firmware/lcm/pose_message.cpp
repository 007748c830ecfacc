#include "firmware/lcm/pose_message.hpp"

#include <cmath>

namespace slamsensor::firmware {
namespace {

constexpr bool is_code(std::int8_t code, auto last) noexcept {
  return code >= 0 && code <= static_cast<std::int8_t>(last);
}

void put_matrix(const Eigen::Matrix3d& from, std::array<double, 9>& into) noexcept {
  for (std::size_t i = 0; i < into.size(); ++i) {
    into[i] = from(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
  }
}

void take_matrix(const std::array<double, 9>& from, Eigen::Matrix3d& into) noexcept {
  for (std::size_t i = 0; i < from.size(); ++i) {
    into(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) = from[i];
  }
}

void put_fix(const core::Fix& fix, PoseMessage& message) noexcept {
  message.scan_start_utc_ns = fix.time.start_utc.count();
  message.scan_middle_utc_ns = fix.time.middle_utc.count();
  message.scan_end_utc_ns = fix.time.end_utc.count();
  message.scan_end_monotonic_ns = fix.time.end_monotonic.count();
  message.scan = fix.scan;
  message.status = static_cast<std::int8_t>(fix.status);
  message.reason = static_cast<std::int8_t>(fix.reason);
  message.search_end = static_cast<std::int8_t>(fix.search_end);
  message.x_m = fix.pose_W.x_m;
  message.y_m = fix.pose_W.y_m;
  message.heading_rad = fix.pose_W.heading_rad;
  put_matrix(fix.covariance, message.covariance);
  message.error_xi = fix.error_xi;
  message.matches = fix.matches;
  message.landmarks_seen = fix.landmarks_seen;
  message.landmarks_in_map = fix.landmarks_in_map;
  message.expected_false_alarms = fix.expected_false_alarms;
  message.weight_best = static_cast<std::int64_t>(fix.weight_best);
  message.weight_runner_up = static_cast<std::int64_t>(fix.weight_runner_up);
  message.jumps = fix.jumps;
  message.map = core::has_pose(fix) ? fix.map : 0;
  message.home = fix.home;
  message.protection_radius_m = fix.protection_radius_m;
  put_matrix(fix.covariance_near, message.covariance_near);
}

}  // namespace

bool is_sound(const PoseMessage& message) noexcept {
  return is_code(message.status, core::FixStatus::Fix) && is_code(message.reason, core::FixReason::NoScan) &&
         is_code(message.search_end, core::SearchEnd::Deadline) &&
         is_code(message.source, SourceMode::Emulated);
}

std::size_t encode_pose(const FixReport& report, std::span<std::uint8_t> out) noexcept {
  PoseMessage message;
  put_fix(report.fix, message);
  message.utime = message.scan_middle_utc_ns / 1000;
  message.report_monotonic_ns = report.monotonic.count();
  message.uptime_ns = report.uptime.count();
  message.time_to_first_fix_ns = report.time_to_first_fix ? report.time_to_first_fix->count() : -1;
  message.initialization = static_cast<std::int64_t>(report.initialization);
  message.source = static_cast<std::int8_t>(report.source);
  return encode_lcm(message, out);
}

std::size_t encode_bot_core_pose(const FixReport& report, std::span<std::uint8_t> out) noexcept {
  if (report.fix.status != core::FixStatus::Fix) {
    return 0;
  }
  const core::Pose2& pose = report.fix.pose_W;
  const double half_rad = pose.heading_rad / 2.0;
  BotCorePose message;
  message.utime = report.fix.time.middle_utc.count() / 1000;
  message.pos = {pose.x_m, pose.y_m, 0.0};
  message.orientation = {std::cos(half_rad), 0.0, 0.0, std::sin(half_rad)};
  return encode_lcm(message, out);
}

core::Fix fix_of(const PoseMessage& message) noexcept {
  core::Fix fix;
  fix.time.start_utc = std::chrono::nanoseconds(message.scan_start_utc_ns);
  fix.time.middle_utc = std::chrono::nanoseconds(message.scan_middle_utc_ns);
  fix.time.end_utc = std::chrono::nanoseconds(message.scan_end_utc_ns);
  fix.time.end_monotonic = std::chrono::nanoseconds(message.scan_end_monotonic_ns);
  fix.scan = static_cast<std::uint32_t>(message.scan);
  fix.status = static_cast<core::FixStatus>(message.status);
  fix.reason = static_cast<core::FixReason>(message.reason);
  fix.search_end = static_cast<core::SearchEnd>(message.search_end);
  fix.pose_W = {message.x_m, message.y_m, message.heading_rad};
  take_matrix(message.covariance, fix.covariance);
  fix.error_xi = static_cast<std::uint32_t>(message.error_xi);
  fix.matches = static_cast<std::uint32_t>(message.matches);
  fix.landmarks_seen = static_cast<std::uint32_t>(message.landmarks_seen);
  fix.landmarks_in_map = static_cast<std::uint32_t>(message.landmarks_in_map);
  fix.expected_false_alarms = message.expected_false_alarms;
  fix.weight_best = static_cast<std::uint64_t>(message.weight_best);
  fix.weight_runner_up = static_cast<std::uint64_t>(message.weight_runner_up);
  fix.jumps = static_cast<std::uint32_t>(message.jumps);
  fix.map = static_cast<std::uint32_t>(message.map);
  fix.home = static_cast<std::uint32_t>(message.home);
  fix.protection_radius_m = message.protection_radius_m;
  take_matrix(message.covariance_near, fix.covariance_near);
  return fix;
}

}  // namespace slamsensor::firmware
