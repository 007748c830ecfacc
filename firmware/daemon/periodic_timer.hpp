#pragma once

#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::firmware {

enum class TimerEvent : std::uint8_t {
  Wakes,
  PeriodsSkipped,  ///< that were over before the step of an earlier one had ended
  DeadlineMisses,  ///< steps that ended later than the deadline after they were due
};

/// Calls a step at a fixed period, and keeps the books of how well that goes (slips are counted, never made
/// up for). One thread. No allocation, no lock.
class PeriodicTimer {
 public:
  /// `period` is positive. The first step is due at once.
  PeriodicTimer(hal::Stamp period, hal::Stamp deadline) noexcept;

  /// Sleeps until the next step is due and returns the time then.
  [[nodiscard]] hal::Stamp wait() noexcept;
  /// The next step is due at once: the thread was stopped meanwhile. The books go on.
  void restart() noexcept { is_first_ = true; }
  /// The step has ended at `now`.
  void end_step(hal::Stamp now) noexcept;

  /// When the step under way was due.
  [[nodiscard]] hal::Stamp due() const noexcept { return due_; }
  /// Worst time from due to awake since construction.
  [[nodiscard]] hal::Stamp wake_latency_max() const noexcept { return wake_latency_max_; }
  /// Worst time that a step took.
  [[nodiscard]] hal::Stamp step_max() const noexcept { return step_max_; }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(TimerEvent event) const noexcept { return counters_[event]; }

  /// `wait` without the sleep, for tests: the step due is begun at `now`.
  void begin_step(hal::Stamp now) noexcept;

 private:
  hal::Stamp period_;
  hal::Stamp deadline_;
  hal::Stamp due_{};
  hal::Stamp begun_{};
  bool is_first_ = true;
  hal::Stamp wake_latency_max_{};
  hal::Stamp step_max_{};
  hal::Counters<TimerEvent, 3> counters_;
};

}  // namespace slamsensor::firmware
