#pragma once

#include "firmware/lcm/lcm_messages.hpp"

#include <vector>

namespace slamsensor::tests {

/// A report in which no two numbers are the same.
inline firmware::FixReport sample_report() {
  firmware::FixReport report;
  core::Fix& fix = report.fix;
  fix.time = {std::chrono::nanoseconds(1'752'488'130'000'000'001),
              std::chrono::nanoseconds(1'752'488'140'000'000'002),
              std::chrono::nanoseconds(1'752'488'150'000'000'003), std::chrono::nanoseconds(98'765'432'101)};
  fix.scan = 4'294'967'290U;
  fix.status = core::FixStatus::Fix;
  fix.reason = core::FixReason::None;
  fix.search_end = core::SearchEnd::Share;
  fix.pose_W = {12.5, -7.25, 2.75};
  fix.covariance << 0.01, 0.001, 0.0001, 0.001, 0.02, 0.0002, 0.0001, 0.0002, 0.00003;
  fix.error_xi = 5;
  fix.matches = 17;
  fix.landmarks_seen = 21;
  fix.landmarks_in_map = 345;
  fix.expected_false_alarms = 1.5e-9;
  fix.weight_best = 7777;
  fix.weight_runner_up = 6666;
  fix.jumps = 2;
  fix.map = 3;
  fix.home = 3;
  fix.protection_radius_m = 0.9;
  fix.covariance_near << 0.004, 0.0004, 0.00004, 0.0004, 0.005, 0.00005, 0.00004, 0.00005, 0.000006;
  report.source = firmware::SourceMode::Emulated;
  report.monotonic = std::chrono::nanoseconds(98'865'432'101);
  report.uptime = std::chrono::seconds(86);
  report.time_to_first_fix = std::chrono::milliseconds(15'250);
  report.initialization = 0xFEDC'BA98'7654'3210U;
  return report;
}

inline constexpr std::array<hal::Counter, 3> kSampleCounters = {
    {{"bytes_refused", 3}, {"replies_late", 0}, {"resynchronised", 0xFFFF'FFFF'FFFFU}}};

inline firmware::SensorStatus sample_status() {
  firmware::SensorStatus status;
  status.state = firmware::SensorState::Fixed;
  status.report = sample_report();
  firmware::HeadStatus& head = status.head;
  head.stamp = std::chrono::nanoseconds(98'800'000'000);
  head.pan_tilt.state = hal::DeviceState::Ready;
  head.pan_tilt.model = hal::FixedText<80>("PTU-46-17.5");
  head.pan_tilt.recoveries = 2;
  head.pan_tilt.last_recovery = std::chrono::milliseconds(1234);
  head.pan_tilt.counters.append(kSampleCounters);
  head.rangefinder.state = hal::DeviceState::Starting;
  head.rangefinder.problem = firmware::ProblemText("no reply at 115200 baud; check cable and power");
  head.phase = "scanning";
  head.problem = firmware::ProblemText("waiting for the rangefinder");
  head.held = true;
  head.scan = 12;
  head.line = 5;
  head.lines = 51;
  head.pan_rad = -0.75;
  head.tilt_rad = 0.125;
  head.latency_s = 0.0051;
  head.latency_sigma_s = 0.0001;
  head.readings_hz = 999.5;
  head.readings = 3'060'000;
  head.wake_latency_max = std::chrono::microseconds(85);
  for (int i = 0; i < 10; ++i) {
    head.counters.append(kSampleCounters);
  }
  status.slam = {.scans = 12,
                 .fixes = 11,
                 .landmarks = 345,
                 .hypotheses = 3,
                 .local_maps = 2,
                 .local_landmarks = 31,
                 .map_revision = 44,
                 .frozen = true,
                 .process_last = std::chrono::milliseconds(7),
                 .process_max = std::chrono::milliseconds(9),
                 .counters = {}};
  status.map_name = hal::FixedText<64>("orchard");
  status.map_saved_ago = std::chrono::seconds(31);
  status.map_unsaved = true;
  status.realtime = true;
  return status;
}

struct SampleMap {
  std::vector<core::MapLandmark> landmarks;
  std::vector<core::Point2> positions_W;

  explicit SampleMap(std::uint32_t size) {
    for (std::uint32_t i = 0; i < size; ++i) {
      landmarks.push_back({.id = 10 + 3 * i,
                           .xi = i % 7,
                           .sightings = i + 1,
                           .last_scan = 2 * i,
                           .sigma_m = 0.25F * static_cast<float>(i),
                           .size = {0.125F * static_cast<float>(i % 9), static_cast<float>(i % 3)}});
      positions_W.emplace_back(0.5 * i, -0.25 * i);
    }
  }
  [[nodiscard]] firmware::LcmMapView view() const {
    return {std::chrono::nanoseconds(1'752'488'151'000'000'000), 99, 44, landmarks, positions_W};
  }
};

inline std::vector<core::ScanLandmark> sample_landmarks(std::size_t size) {
  std::vector<core::ScanLandmark> landmarks;
  for (std::size_t i = 0; i < size; ++i) {
    const auto x = static_cast<double>(i);
    landmarks.push_back({{0.1 * x, 1.0 / (x + 3.0)}, 1000.0 - x, 0.01 * x});
  }
  return landmarks;
}

inline firmware::LcmScanView view_of(const std::vector<core::ScanLandmark>& landmarks) {
  return {sample_report().initialization, sample_report().fix.scan, sample_report().fix.time, landmarks};
}

inline firmware::LcmRivalsView sample_rivals(std::uint32_t count) {
  firmware::LcmRivalsView view{
      sample_report().initialization, sample_report().fix.scan, sample_report().fix.time, {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    const core::Pose2 pose_W{1.5 * i, -2.25 * i, 0.125 * i};
    static_cast<void>(view.rivals.try_push_back({pose_W, 20 - i}));
  }
  return view;
}

}  // namespace slamsensor::tests
