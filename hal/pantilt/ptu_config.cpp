#include "hal/pantilt/ptu_config.hpp"

#include <algorithm>
#include <string>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kRatesMax = 8;
constexpr std::uint32_t kBaudMin = 300;
constexpr std::uint32_t kBaudMax = 921600;
constexpr double kPollMaxHz = 200.0;
constexpr double kRestPollMinHz = 0.1;
constexpr Stamp kWaitMax = std::chrono::minutes(10);

bool baud_fits(std::uint32_t baud) noexcept {
  return baud >= kBaudMin && baud <= kBaudMax;
}

/// What is wrong with `config`, or nothing.
std::string config_problem(const PtuConfig& config) {
  const auto& rates = config.rates_baud;
  if (rates.empty() || rates.size() > kRatesMax || !std::all_of(rates.begin(), rates.end(), baud_fits)) {
    return "rates_baud must be 1 to 8 rates of 300 to 921600 baud";
  }
  if (config.fast_baud != 0 && !baud_fits(config.fast_baud)) {
    return "fast_baud is " + std::to_string(config.fast_baud) + "; it must be 0 or 300 to 921600 baud";
  }
  if (!(config.poll_hz >= 1.0 && config.poll_hz <= kPollMaxHz)) {
    return "poll_hz is " + std::to_string(config.poll_hz) + "; it must be 1 to 200";
  }
  if (!(config.rest_poll_hz >= kRestPollMinHz && config.rest_poll_hz <= config.poll_hz)) {
    return "rest_poll_hz is " + std::to_string(config.rest_poll_hz) + "; it must be 0.1 to poll_hz";
  }
  const auto waits = {config.query_timeout, config.motion_timeout, config.mode_timeout, config.reset_timeout,
                      config.wake_wait,     config.drain,          config.baud_wait,    config.retry_wait};
  if (std::any_of(waits.begin(), waits.end(),
                  [](Stamp wait) { return wait <= Stamp{} || wait > kWaitMax; })) {
    return "every time-out and wait must be more than 0 and at most 10 minutes";
  }
  if (config.move_latency_max < Stamp{} || config.move_latency_max > kWaitMax ||
      config.stamp_slack < Stamp{} || config.stamp_slack > kWaitMax || config.half_width_max <= Stamp{} ||
      config.half_width_max > kWaitMax) {
    return "move_latency_max and stamp_slack must be 0 to 10 minutes, half_width_max more than 0";
  }
  return {};
}

}  // namespace

std::optional<InitError> ptu_config_error(const PtuConfig& config) {
  const std::string problem = config_problem(config);
  if (problem.empty()) {
    return std::nullopt;
  }
  return InitError{"pan-tilt unit: " + problem + "; change the configuration"};
}

}  // namespace slamsensor::hal
