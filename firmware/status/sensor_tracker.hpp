#pragma once

#include "firmware/config/daemon_config.hpp"
#include "firmware/status/sensor_status.hpp"
#include "hal/device.hpp"
#include "hal/stamp.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {

/// Follows the state of one device: why it was lost, how often it came back after a loss, and how long that
/// took. Scan thread.
class DeviceWatch {
 public:
  /// After each step of the device: its state, and its problem.
  void step(hal::DeviceState state, std::string_view problem, hal::Stamp now) noexcept {
    const bool is_ready = state == hal::DeviceState::Ready;
    if (was_ready_ && !is_ready) {
      lost_ = now;
      last_loss_ = ProblemText(problem);
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
    std::string_view problem = device.problem();
    for (const std::string_view more : {device.timing_doubt(), device.remark()}) {
      problem = problem.empty() ? more : problem;
    }
    status.problem = ProblemText(problem);
    status.last_loss = last_loss_;
    status.recoveries = recoveries_;
    status.last_recovery = last_recovery_;
    status.counters.size = 0;
    status.counters.append(device.counters());
  }

 private:
  bool was_ready_ = false;
  bool has_been_ready_ = false;
  hal::Stamp lost_{};
  ProblemText last_loss_;
  std::uint32_t recoveries_ = 0;
  hal::Stamp last_recovery_{};
};

/// Decides from the last fix, the state of the devices and the time how the sensor stands, and makes the one
/// report that all outputs write. No clock; one thread.
///
///   Starting   the devices have not all answered since start
///   Faulted    a device that has answered does not any more: no fix, reason device (the devices are those of
///   the
///              head, and the inclinometer when one is configured); or the devices answer, and no scan comes
///              of it (a blocked axis, replies too late, no usable readings)
///   Held       scanning is not allowed: no fix, reason device
///              After both the last fix stays void (Lost, reason device) until a scan has been made.
///   Scanning   no scan has been localised yet, or none in this map: no fix, reason no_scan
///   Fixed, Ambiguous, Lost   as the last scan ended; Lost with the reason stale when no scan has come for
///              FixConfig::stale_s, with the reason moved when the carrier moved while it was scanned,
///              with the reason timing while or since that of a device is in doubt
class SensorTracker {
 public:
  /// `initialization` differs from start to start; `start` is the start of the daemon.
  SensorTracker(const FixConfig& config, SourceMode source, std::uint64_t initialization, hal::Stamp start)
      : config_(config), source_(source), initialization_(initialization), start_(start) {}

  void set_config(const FixConfig& config) { config_ = config; }
  /// A scan has been localised, or has failed to; `made` is when.
  void on_fix(const core::Fix& fix, hal::Stamp made);
  void on_head(const HeadStatus& head);
  /// The map was replaced or forgotten: what was a fix in the former one is none in this one.
  void on_new_map() { fix_.reset(); }

  [[nodiscard]] SensorState state(hal::Stamp now) const { return judge(now).state; }
  /// Every field as of `now`: the status is Fix in the state Fixed alone.
  [[nodiscard]] FixReport report(hal::Stamp now) const;

 private:
  struct Judgement {
    SensorState state = SensorState::Starting;
    std::optional<core::FixReason> void_because;  // the last fix does not count any more
  };
  [[nodiscard]] Judgement judge(hal::Stamp now) const;

  FixConfig config_;
  SourceMode source_;
  std::uint64_t initialization_;
  hal::Stamp start_;
  std::optional<core::Fix> fix_;
  std::optional<core::FixReason> void_;  // something that happened since
  hal::Stamp made_{};
  std::optional<hal::Stamp> time_to_first_fix_;
  bool all_ready_ = false;
  bool were_ready_ = false;
  bool is_held_ = false;
  bool is_timing_in_doubt_ = false;
  bool is_failing_ = false;
};

}  // namespace slamsensor::firmware
