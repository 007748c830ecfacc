#pragma once

#include "firmware/output/position_error.hpp"
#include "firmware/status/sensor_status.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

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

[[nodiscard]] inline std::array<NamedDevice, 2> devices_of(const SensorStatus& status) noexcept {
  return {{{"pan_tilt", "pan-tilt", &status.head.pan_tilt},
           {"rangefinder", "rangefinder", &status.head.rangefinder}}};
}

/// What keeps the head from scanning, if it is not what a device says of itself.
[[nodiscard]] inline std::string_view head_problem(const SensorStatus& status) noexcept {
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

[[nodiscard]] inline std::array<NamedCounters, 5> counters_of(const SensorStatus& status) noexcept {
  return {{{"pan_tilt", &status.head.pan_tilt.counters},
           {"rangefinder", &status.head.rangefinder.counters},
           {"head", &status.head.counters},
           {"slam", &status.slam.counters},
           {"outputs", &status.outputs}}};
}

/// Whether `fix` has a pose, if only the better one of two.
[[nodiscard]] inline bool has_pose(const core::Fix& fix) noexcept {
  return fix.status != core::FixStatus::NoFix;
}

/// 1 sigma along the longest axis of the position's ellipse, m, and of the heading, rad.
struct PoseSigma {
  double position_m = 0.0;
  double heading_rad = 0.0;
};

/// None when the covariance is not usable.
[[nodiscard]] inline std::optional<PoseSigma> pose_sigma(const core::Fix& fix) noexcept {
  if (!usable_covariance(fix.covariance)) {
    return std::nullopt;
  }
  return PoseSigma{position_error(fix.covariance.topLeftCorner<2, 2>()).major_m,
                   std::sqrt(fix.covariance(2, 2))};
}

}  // namespace slamsensor::firmware
