#pragma once

#include "firmware/status/sensor_status.hpp"
#include "hal/counters.hpp"
#include "hal/gpio/gpio.hpp"
#include "hal/stamp.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace slamsensor::firmware {

enum class GpioOutputEvent : std::uint8_t {
  PulsesBegun,
  PulsesJoined,  ///< fixes that came while the pulse of the one before lasted: it is longer
  LedFailed,     ///< changes that the line did not take
  PulseFailed,
};
inline constexpr std::size_t kGpioOutputEvents = 4;

/// Lines that are not used are null.
struct GpioOutputLines {
  std::unique_ptr<hal::GpioOutput> led;
  std::unique_ptr<hal::GpioOutput> pulse;
};

/// Status LED and fix pulse. The LED is on with a fix and off without one; it blinks once a second while a
/// device is not there (Starting, Faulted) and four times a second while scanning is held. One thread.
class GpioOutputs {
 public:
  /// A pulse lasts `pulse`, positive.
  GpioOutputs(GpioOutputLines lines, hal::Stamp pulse) noexcept;
  /// Both lines are left inactive.
  ~GpioOutputs();
  GpioOutputs(const GpioOutputs&) = delete;
  GpioOutputs& operator=(const GpioOutputs&) = delete;

  /// A new fix: the pulse line is active until `pulse` after `now`.
  void on_fix(hal::Stamp now) noexcept;
  /// Brings both lines to what `state` and `now` ask for. A line that failed is tried again.
  void step(SensorState state, hal::Stamp now) noexcept;

  /// When step() is to be called next, in the state of the last call; hal::kNever: when something changes.
  [[nodiscard]] hal::Stamp next_change(hal::Stamp now) const noexcept;

  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(GpioOutputEvent event) const noexcept { return counters_[event]; }

 private:
  void set(hal::GpioOutput* line, hal::GpioLevel level, GpioOutputEvent failure) noexcept;

  GpioOutputLines lines_;
  hal::Stamp pulse_;
  hal::Stamp pulse_end_{};  // zero: no pulse
  SensorState state_ = SensorState::Starting;
  hal::Counters<GpioOutputEvent, kGpioOutputEvents> counters_;
};

}  // namespace slamsensor::firmware
