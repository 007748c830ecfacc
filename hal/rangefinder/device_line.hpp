#pragma once

#include "hal/transport/byte_link.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::hal {

/// What a start-up needs of the line to its device, whichever kind it is.
class DeviceLine {
 public:
  DeviceLine() = default;
  DeviceLine(const DeviceLine&) = delete;
  DeviceLine& operator=(const DeviceLine&) = delete;
  virtual ~DeviceLine() = default;

  virtual void service(Stamp now) noexcept = 0;
  [[nodiscard]] virtual bool is_up() const noexcept = 0;
  [[nodiscard]] virtual std::string_view problem() const noexcept = 0;
  [[nodiscard]] virtual std::uint32_t epoch() const noexcept = 0;

  /// Sends a request whole (Ok) or not at all.
  [[nodiscard]] virtual LinkStatus send(std::span<const std::uint8_t> bytes) noexcept = 0;

  /// Goes on to the next of the line rates at which the device may be, from the last to the first; does
  /// nothing on a line that has one. A rate that was kept comes before each of the others: what was lost is
  /// more often an answer than the rate.
  virtual void next_rate() noexcept = 0;

  /// The device is at work at the present rate.
  virtual void keep_rate() noexcept = 0;
};

}  // namespace slamsensor::hal
