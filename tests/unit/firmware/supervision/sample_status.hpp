#pragma once

#include "firmware/status/sensor_status.hpp"

#include <array>

namespace slamsensor::firmware {

/// A sensor with a fix, whose rangefinder has just gone.
inline SensorStatus fixed_status() {
  static constexpr std::array<hal::Counter, 1> kCounters = {{{"replies_lost", 3}}};
  SensorStatus status;
  status.state = SensorState::Fixed;
  core::Fix& fix = status.report.fix;
  fix.status = core::FixStatus::Fix;
  fix.reason = core::FixReason::None;
  fix.search_end = core::SearchEnd::Complete;
  fix.scan = 41;
  fix.pose_W = {12.5, -3.25, 0.0};
  fix.covariance.diagonal() << 0.04, 0.01, 0.0001;
  fix.map = fix.home = 2;
  fix.covariance_near.diagonal() << 0.0004, 0.0009, 0.0001;
  fix.protection_radius_m = 1.05;
  fix.matches = 23;
  fix.landmarks_seen = 30;
  fix.landmarks_in_map = 512;
  status.report.time_to_first_fix = std::chrono::seconds(31);
  status.head.pan_tilt.state = hal::DeviceState::Ready;
  status.head.pan_tilt.model = hal::FixedText<80>("PTU-46-17.5");
  status.head.pan_tilt.recoveries = 2;
  status.head.pan_tilt.last_recovery = std::chrono::milliseconds(350);
  status.head.pan_tilt.counters.append(kCounters);
  status.head.rangefinder.problem = ProblemText("no reply at 9600 baud; check cable");
  status.slam.scans = 42;
  status.slam.fixes = 40;
  status.slam.landmarks = 512;
  status.slam.hypotheses = 3;
  status.map_name = hal::FixedText<64>("default");
  status.map_saved_ago = std::chrono::seconds(12);
  return status;
}

}  // namespace slamsensor::firmware
