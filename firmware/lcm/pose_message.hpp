#pragma once

#include "firmware/lcm/message.hpp"
#include "firmware/status/sensor_status.hpp"

namespace slamsensor::firmware {

/// slamsensor.pose_t (types/slamsensor_pose_t.lcm): one FixReport. Units, frames and codes stand in the .lcm
/// file.
struct PoseMessage {
  std::int64_t utime = 0;
  std::int64_t scan_start_utc_ns = 0;
  std::int64_t scan_middle_utc_ns = 0;
  std::int64_t scan_end_utc_ns = 0;
  std::int64_t scan_end_monotonic_ns = 0;
  std::int64_t report_monotonic_ns = 0;
  std::int64_t uptime_ns = 0;
  std::int64_t time_to_first_fix_ns = -1;
  std::int64_t initialization = 0;
  std::int64_t scan = 0;
  std::int8_t status = 0;
  std::int8_t reason = 0;
  std::int8_t search_end = 0;
  std::int8_t source = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
  std::array<double, 9> covariance{};
  std::int64_t error_xi = 0;
  std::int64_t matches = 0;
  std::int64_t landmarks_seen = 0;
  std::int64_t landmarks_in_map = 0;
  double expected_false_alarms = 0.0;
  std::int64_t weight_best = 0;
  std::int64_t weight_runner_up = 0;
  std::int64_t jumps = 0;
  std::int64_t map = 0;
  std::int64_t home = 0;
  double protection_radius_m = 0.0;
  std::array<double, 9> covariance_near{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("scan_start_utc_ns", m.scan_start_utc_ns);
    visit("scan_middle_utc_ns", m.scan_middle_utc_ns);
    visit("scan_end_utc_ns", m.scan_end_utc_ns);
    visit("scan_end_monotonic_ns", m.scan_end_monotonic_ns);
    visit("report_monotonic_ns", m.report_monotonic_ns);
    visit("uptime_ns", m.uptime_ns);
    visit("time_to_first_fix_ns", m.time_to_first_fix_ns);
    visit("initialization", m.initialization);
    visit("scan", m.scan);
    visit("status", m.status);
    visit("reason", m.reason);
    visit("search_end", m.search_end);
    visit("source", m.source);
    visit("x_m", m.x_m);
    visit("y_m", m.y_m);
    visit("heading_rad", m.heading_rad);
    visit("covariance", m.covariance);
    visit("error_xi", m.error_xi);
    visit("matches", m.matches);
    visit("landmarks_seen", m.landmarks_seen);
    visit("landmarks_in_map", m.landmarks_in_map);
    visit("expected_false_alarms", m.expected_false_alarms);
    visit("weight_best", m.weight_best);
    visit("weight_runner_up", m.weight_runner_up);
    visit("jumps", m.jumps);
    visit("map", m.map);
    visit("home", m.home);
    visit("protection_radius_m", m.protection_radius_m);
    visit("covariance_near", m.covariance_near);
  }
};

/// Whether the codes of `message` are those of enumerators.
[[nodiscard]] bool is_sound(const PoseMessage& message) noexcept;

/// bot_core.pose_t, known to libbot's viewers (types/bot_core_pose_t.lcm).
struct BotCorePose {
  std::int64_t utime = 0;
  std::array<double, 3> pos{};
  std::array<double, 3> vel{};
  std::array<double, 4> orientation{};
  std::array<double, 3> rotation_rate{};
  std::array<double, 3> accel{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("pos", m.pos);
    visit("vel", m.vel);
    visit("orientation", m.orientation);
    visit("rotation_rate", m.rotation_rate);
    visit("accel", m.accel);
  }
};

[[nodiscard]] constexpr bool is_sound(const BotCorePose& /*message*/) noexcept {
  return true;
}

/// Writes slamsensor.pose_t of `report` into `out` and returns its length, 0 when it does not fit.
[[nodiscard]] std::size_t encode_pose(const FixReport& report, std::span<std::uint8_t> out) noexcept;

/// Writes bot_core.pose_t of `report` into `out` and returns its length. That type cannot say that a pose is
/// not valid, so only a fix is written: else 0, as when it does not fit. Height, velocity, rotation rate and
/// acceleration are 0: nothing is known of them.
[[nodiscard]] std::size_t encode_bot_core_pose(const FixReport& report, std::span<std::uint8_t> out) noexcept;

/// The fix in a sound `message`, as it was in the report.
[[nodiscard]] core::Fix fix_of(const PoseMessage& message) noexcept;

}  // namespace slamsensor::firmware
