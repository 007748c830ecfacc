#include "hal/transport/serial_port_config.hpp"

#include "hal/transport/reopen_problem.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::uint32_t kRs485DelayMaxMs = 1000;

std::string line_complaint(const SerialLine& line) {
  if (!is_line_rate(line.baud)) {
    return std::to_string(line.baud) + " baud is not within 50 to 12000000";
  }
  if (line.format.data_bits != 7 && line.format.data_bits != 8) {
    return std::to_string(line.format.data_bits) + " data bits: only 7 or 8 are possible";
  }
  if (line.format.stop_bits != 1 && line.format.stop_bits != 2) {
    return std::to_string(line.format.stop_bits) + " stop bits: only 1 or 2 are possible";
  }
  return {};
}

}  // namespace

std::string complaint(const SerialConfig& config) {
  const bool is_path = !config.path.empty() && config.path.front() == '/' &&
                       config.path.size() <= kDeviceNameMax && config.path.find('\0') == std::string::npos;
  if (!is_path) {
    return "the path must start with / and have at most " + std::to_string(kDeviceNameMax) + " characters";
  }
  if (config.rs485 &&
      std::max(config.rs485->delay_before_send_ms, config.rs485->delay_after_send_ms) > kRs485DelayMaxMs) {
    return "an RS-485 delay is above " + std::to_string(kRs485DelayMaxMs) + " ms";
  }
  if (!is_valid(config.reopen)) {
    return std::string(kReopenRule);
  }
  return line_complaint(config.line);
}

}  // namespace slamsensor::hal
