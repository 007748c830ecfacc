#pragma once

#include "hal/transport/reopen.hpp"
#include "hal/transport/serial_port_line.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace slamsensor::hal {

struct SerialConfig {
  std::string path;   ///< a stable one: a link of /dev/serial/by-id, by-path or an own udev rule
  SerialLine line{};  ///< 50 to 12,000,000 bit/s
  std::optional<Rs485Config> rs485{};
  SerialLatency latency = SerialLatency::Low;
  ReopenConfig reopen{};
};

[[nodiscard]] constexpr bool is_line_rate(std::uint32_t baud) noexcept {
  return baud >= 50 && baud <= 12'000'000;
}

/// What is wrong with `config`, in words that follow the port's name; empty when nothing is.
[[nodiscard]] std::string complaint(const SerialConfig& config);

}  // namespace slamsensor::hal
