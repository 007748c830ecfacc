#pragma once

#include "firmware/status/sensor_status.hpp"
#include "hal/device.hpp"
#include "hal/stamp.hpp"

#include <cstdint>
#include <string_view>

namespace slamsensor::firmware {

/// Follows the state of one device: how often it came back after a loss, and how long that took. Scan thread.
class DeviceWatch {
 public:
  void step(hal::DeviceState state, hal::Stamp now) noexcept {
    const bool is_ready = state == hal::DeviceState::Ready;
    if (was_ready_ && !is_ready) {
      lost_ = now;
    } else if (!was_ready_ && is_ready && has_been_ready_) {
      ++recoveries_;
      last_recovery_ = now - lost_;
    }
    has_been_ready_ = has_been_ready_ || is_ready;
    was_ready_ = is_ready;
  }

  /// Fills in what is known of `device`, whose state was the last one given.
  void report(const hal::Device& device, DeviceStatus& status) const noexcept {
    status.state = device.state();
    const std::string_view problem = device.problem();
    status.problem = ProblemText(problem.empty() ? device.timing_doubt() : problem);
    status.recoveries = recoveries_;
    status.last_recovery = last_recovery_;
    status.counters.size = 0;
    status.counters.append(device.counters());
  }

 private:
  bool was_ready_ = false;
  bool has_been_ready_ = false;
  hal::Stamp lost_{};
  std::uint32_t recoveries_ = 0;
  hal::Stamp last_recovery_{};
};

}  // namespace slamsensor::firmware
