#include "firmware/lcm/lcm_messages.hpp"

#include "firmware/lcm/message.hpp"

#include <algorithm>
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

std::int32_t clamped(std::uint32_t value) noexcept {
  return static_cast<std::int32_t>(std::min<std::uint32_t>(value, INT32_MAX));
}

std::size_t landmarks_in(const LcmMapView& map) noexcept {
  return std::min(map.landmarks.size(), map.positions_W.size());
}

void put_device(const DeviceStatus& device, LcmDevice place, StatusMessage& message) noexcept {
  const auto i = static_cast<std::size_t>(place);
  message.device_state[i] = static_cast<std::int8_t>(device.state);
  message.device_problem[i] = to_lcm_text<192>(device.problem.view());
  message.device_model[i] = to_lcm_text<80>(device.model.view());
  message.device_recoveries[i] = device.recoveries;
  message.device_last_recovery_ns[i] = device.last_recovery.count();
}

void put_head(const HeadStatus& head, StatusMessage& message) noexcept {
  message.held = head.held;
  message.phase = to_lcm_text<16>(head.phase);
  message.problem = to_lcm_text<192>(head.problem.view());
  message.head_monotonic_ns = head.stamp.count();
  message.scan = head.scan;
  message.line = head.line;
  message.lines = head.lines;
  message.pan_rad = head.pan_rad;
  message.tilt_rad = head.tilt_rad;
  message.latency_s = head.latency_s;
  message.latency_sigma_s = head.latency_sigma_s;
  message.readings_hz = head.readings_hz;
  message.readings = static_cast<std::int64_t>(head.readings);
  message.wake_latency_max_ns = head.wake_latency_max.count();
}

void put_slam(const SlamStatus& slam, StatusMessage& message) noexcept {
  message.map_frozen = slam.frozen;
  message.scans = slam.scans;
  message.fixes = slam.fixes;
  message.landmarks = slam.landmarks;
  message.hypotheses = slam.hypotheses;
  message.local_maps = slam.local_maps;
  message.local_landmarks = slam.local_landmarks;
  message.map_revision = static_cast<std::int64_t>(slam.map_revision);
  message.process_last_ns = slam.process_last.count();
  message.process_max_ns = slam.process_max.count();
}

std::size_t parts_of(std::size_t counters) noexcept {
  return std::max<std::size_t>(1, (counters + kLcmCounters - 1) / kLcmCounters);
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

bool is_sound(const ScanMessage& message) noexcept {
  return is_sound_chunk<kScanChunkLandmarks>(message);
}

std::uint32_t scan_chunks(const LcmScanView& scan) noexcept {
  return chunks_of<kScanChunkLandmarks>(scan.landmarks.size());
}

std::size_t encode_scan_chunk(const LcmScanView& scan, std::uint32_t chunk,
                              std::span<std::uint8_t> out) noexcept {
  ScanMessage message;
  if (!number_chunk<kScanChunkLandmarks>(scan.landmarks.size(), chunk, message)) {
    return 0;
  }
  message.utime = scan.time.middle_utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(scan.initialization);
  message.scan = scan.scan;
  message.scan_start_utc_ns = scan.time.start_utc.count();
  message.scan_middle_utc_ns = scan.time.middle_utc.count();
  message.scan_end_utc_ns = scan.time.end_utc.count();
  message.scan_end_monotonic_ns = scan.time.end_monotonic.count();
  const std::size_t first = chunk * kScanChunkLandmarks;
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    const core::ScanLandmark& landmark = scan.landmarks[first + i];
    message.x_m[i] = landmark.position_L.x();
    message.y_m[i] = landmark.position_L.y();
    message.weight[i] = landmark.weight;
    message.diameter_m[i] = landmark.diameter_m;
  }
  return encode_lcm(message, out);
}

core::ScanTime scan_time_of(const ScanMessage& message) noexcept {
  return {std::chrono::nanoseconds(message.scan_start_utc_ns),
          std::chrono::nanoseconds(message.scan_middle_utc_ns),
          std::chrono::nanoseconds(message.scan_end_utc_ns),
          std::chrono::nanoseconds(message.scan_end_monotonic_ns)};
}

std::size_t encode_rivals(const LcmRivalsView& view, std::span<std::uint8_t> out) noexcept {
  if (view.rivals.empty()) {
    return 0;
  }
  RivalsMessage message;
  message.utime = view.time.middle_utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(view.initialization);
  message.scan = view.scan;
  message.count = static_cast<std::int32_t>(view.rivals.size());
  for (std::size_t i = 0; i < view.rivals.size(); ++i) {
    const RivalPlace& rival = view.rivals[i];
    message.x_m[i] = rival.pose_W.x_m;
    message.y_m[i] = rival.pose_W.y_m;
    message.heading_rad[i] = rival.pose_W.heading_rad;
    message.matches[i] = clamped(rival.matches);
  }
  return encode_lcm(message, out);
}

bool is_sound(const MapMessage& message) noexcept {
  return is_sound_chunk<kMapChunkLandmarks>(message);
}

std::uint32_t map_chunks(const LcmMapView& map) noexcept {
  return chunks_of<kMapChunkLandmarks>(landmarks_in(map));
}

std::size_t encode_map_chunk(const LcmMapView& map, std::uint32_t chunk,
                             std::span<std::uint8_t> out) noexcept {
  MapMessage message;
  if (!number_chunk<kMapChunkLandmarks>(landmarks_in(map), chunk, message)) {
    return 0;
  }
  message.utime = map.utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(map.initialization);
  message.revision = static_cast<std::int64_t>(map.revision);
  const std::size_t first = chunk * kMapChunkLandmarks;
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    const core::MapLandmark& landmark = map.landmarks[first + i];
    message.id[i] = landmark.id;
    message.x_m[i] = map.positions_W[first + i].x();
    message.y_m[i] = map.positions_W[first + i].y();
    message.sigma_m[i] = static_cast<double>(landmark.sigma_m);
    message.diameter_m[i] = landmark.size.diameter_m();
    message.xi[i] = clamped(landmark.xi);
    message.sightings[i] = clamped(landmark.sightings);
    message.last_scan[i] = clamped(landmark.last_scan);
  }
  return encode_lcm(message, out);
}

bool is_sound(const StatusMessage& message) noexcept {
  const bool devices = std::all_of(message.device_state.begin(), message.device_state.end(),
                                   [](auto state) { return is_code(state, hal::DeviceState::Faulted); });
  return devices && is_code(message.state, SensorState::Faulted) &&
         is_code(message.source, SourceMode::Emulated);
}

std::size_t encode_status(const SensorStatus& status, hal::Stamp utc, std::span<std::uint8_t> out) noexcept {
  StatusMessage message;
  message.utime = utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(status.report.initialization);
  message.uptime_ns = status.report.uptime.count();
  message.time_to_first_fix_ns =
      status.report.time_to_first_fix ? status.report.time_to_first_fix->count() : -1;
  message.state = static_cast<std::int8_t>(status.state);
  message.source = static_cast<std::int8_t>(status.report.source);
  message.realtime = status.realtime;
  message.recording = status.recording;
  message.map_unsaved = status.map_unsaved;
  message.map_name = to_lcm_text<64>(status.map_name.view());
  message.map_saved_ago_ns = status.map_saved_ago == hal::kNever ? -1 : status.map_saved_ago.count();
  put_head(status.head, message);
  put_device(status.head.pan_tilt, LcmDevice::PanTilt, message);
  put_device(status.head.rangefinder, LcmDevice::Rangefinder, message);
  put_slam(status.slam, message);
  return encode_lcm(message, out);
}

bool is_sound(const CountersMessage& message) noexcept {
  return is_code(message.station, LcmStation::Outputs) && message.part >= 0 && message.part < message.parts &&
         message.parts <= static_cast<std::int8_t>(kLcmCounterParts) && message.count >= 0 &&
         message.count <= static_cast<std::int8_t>(kLcmCounters);
}

std::span<const hal::Counter> counters_of(const SensorStatus& status, LcmStation station) noexcept {
  switch (station) {
    case LcmStation::PanTilt:
      return status.head.pan_tilt.counters.all();
    case LcmStation::Rangefinder:
      return status.head.rangefinder.counters.all();
    case LcmStation::Head:
      return status.head.counters.all();
    case LcmStation::Slam:
      return status.slam.counters.all();
    case LcmStation::Outputs:
      break;
  }
  return status.outputs.all();
}

std::size_t encode_counters(const SensorStatus& status, hal::Stamp utc, LcmStation station, std::size_t part,
                            std::span<std::uint8_t> out) noexcept {
  const std::span<const hal::Counter> counters = counters_of(status, station);
  const std::size_t parts = parts_of(counters.size());
  if (part >= parts) {
    return 0;
  }
  const std::span<const hal::Counter> sent =
      counters.subspan(part * kLcmCounters, std::min(kLcmCounters, counters.size() - part * kLcmCounters));
  CountersMessage message;
  message.utime = utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(status.report.initialization);
  message.station = static_cast<std::int8_t>(station);
  message.part = static_cast<std::int8_t>(part);
  message.parts = static_cast<std::int8_t>(parts);
  message.count = static_cast<std::int8_t>(sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    message.value[i] = static_cast<std::int64_t>(sent[i].value);
    message.name[i] = to_lcm_text<40>(sent[i].name);
  }
  return encode_lcm(message, out);
}

}  // namespace slamsensor::firmware
