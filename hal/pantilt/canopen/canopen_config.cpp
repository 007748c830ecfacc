#include "hal/pantilt/canopen/canopen_config.hpp"

#include "hal/pantilt/canopen/cia402.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace slamsensor::hal {
namespace {

constexpr double kPollMaxHz = 1000.0;
constexpr double kRestPollMinHz = 0.1;
constexpr double kCountsMax = 1e9;  // per radian: two turns still fit the 32 bits of a position
constexpr double kRadMax = 100.0;
constexpr std::uint8_t kAttemptsMax = 10;
constexpr Stamp kWaitMax = std::chrono::minutes(10);
constexpr Stamp kHeartbeatMin = std::chrono::milliseconds(10);
constexpr Stamp kHeartbeatMax = std::chrono::seconds(30);

bool within(double value, double low, double high) noexcept {
  return value >= low && value <= high;  // false for what is not a number
}

std::string axis_problem(const CanopenAxisConfig& axis) {
  if (axis.node < 1 || axis.node > kNodeMax) {
    return "node is " + std::to_string(axis.node) + "; it must be 1 to 127";
  }
  if (!within(axis.counts_per_rad, 1.0, kCountsMax)) {
    return "counts_per_rad is " + std::to_string(axis.counts_per_rad) + "; it must be 1 to 1e9";
  }
  if (!within(axis.speed_units_per_rad, 0.0, kCountsMax) ||
      !within(axis.acceleration_units_per_rad, 0.0, kCountsMax)) {
    return "speed_units_per_rad and acceleration_units_per_rad must be 0 to 1e9";
  }
  if (!within(axis.min_rad, -kRadMax, kRadMax) || !within(axis.max_rad, -kRadMax, kRadMax) ||
      axis.min_rad >= axis.max_rad) {
    return "min_rad must be below max_rad, both within -100 to 100";
  }
  if (!within(axis.speed_max_radps, 1e-6, kRadMax) || !within(axis.acceleration_radps2, 0.0, 1e4) ||
      !within(axis.window_rad, 1e-7, 1.0)) {
    return "speed_max_radps must be 1e-6 to 100, acceleration_radps2 0 to 1e4, window_rad 1e-7 to 1";
  }
  return {};
}

std::string waits_problem(const CanopenConfig& config) {
  const auto waits = {config.sdo_timeout,    config.boot_wait,           config.state_timeout,
                      config.homing_timeout, config.acknowledge_timeout, config.position_timeout,
                      config.retry_first,    config.retry_longest,       config.heartbeat_timeout};
  if (std::any_of(waits.begin(), waits.end(),
                  [](Stamp wait) { return wait <= Stamp{} || wait > kWaitMax; })) {
    return "every time-out and wait must be more than 0 and at most 10 minutes";
  }
  if (config.retry_first > config.retry_longest) {
    return "retry_first must not be above retry_longest";
  }
  if (config.heartbeat < kHeartbeatMin || config.heartbeat > kHeartbeatMax ||
      config.heartbeat_timeout <= config.heartbeat) {
    return "heartbeat must be 10 ms to 30 s, heartbeat_timeout longer";
  }
  if (config.sync_half_width < Stamp{} || config.sync_half_width > kWaitMax) {
    return "sync_half_width must be 0 to 10 minutes";
  }
  return {};
}

std::string config_problem(const CanopenConfig& config) {
  for (const CanopenAxisConfig* axis : {&config.pan, &config.tilt}) {
    const std::string problem = axis_problem(*axis);
    if (!problem.empty()) {
      return (axis == &config.pan ? "pan: " : "tilt: ") + problem;
    }
  }
  if (config.homing == CanopenHoming::Always &&
      (config.pan.homing_method == 0 || config.tilt.homing_method == 0)) {
    return "homing is always, which needs a homing_method of both axes";
  }
  if (config.pan.node == config.tilt.node) {
    return "pan and tilt are both node " + std::to_string(config.pan.node) + "; they must differ";
  }
  if (!within(config.poll_hz, 1.0, kPollMaxHz)) {
    return "poll_hz is " + std::to_string(config.poll_hz) + "; it must be 1 to 1000";
  }
  if (!within(config.rest_poll_hz, kRestPollMinHz, config.poll_hz)) {
    return "rest_poll_hz is " + std::to_string(config.rest_poll_hz) + "; it must be 0.1 to poll_hz";
  }
  if (config.sdo_attempts < 1 || config.sdo_attempts > kAttemptsMax) {
    return "sdo_attempts is " + std::to_string(config.sdo_attempts) + "; it must be 1 to 10";
  }
  return waits_problem(config);
}

}  // namespace

std::optional<InitError> canopen_config_error(const CanopenConfig& config) {
  const std::string problem = config_problem(config);
  if (problem.empty()) {
    return std::nullopt;
  }
  return InitError{"CANopen pan-tilt unit: " + problem + "; change the configuration"};
}

}  // namespace slamsensor::hal
