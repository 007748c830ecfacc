#pragma once

#include "firmware/config/daemon_config.hpp"
#include "firmware/status/sensor_status.hpp"
#include "hal/counters.hpp"
#include "hal/gpio/gpio.hpp"
#include "hal/gpio/open_gpio.hpp"
#include "hal/init_error.hpp"
#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace slamsensor::firmware {

/// What the input lines ask of the scan thread.
struct GpioOrders {
  bool scan_wanted = false;     ///< the trigger became active since the last poll
  bool interlock_open = false;  ///< no scanning: the interlock is not active, or cannot be read
};

enum class GpioInputEvent : std::uint8_t {
  TriggerEdges,       ///< to active, debounced
  InterlockOpenings,  ///< seen to open, or lost
  InterlockLost,      ///< polls in which the line could not be read
};
inline constexpr std::size_t kGpioInputEvents = 3;

/// Lines that are not used are null.
struct GpioInputLines {
  std::unique_ptr<hal::GpioInput> trigger;
  std::unique_ptr<hal::GpioInput> interlock;  ///< must report both edges
};

/// Scan trigger and laser interlock. The scan thread's: no allocation and no waiting, a few system calls a
/// poll.
class GpioInputs {
 public:
  explicit GpioInputs(GpioInputLines lines) noexcept;

  /// What the lines ask for at `now`. An interlock that was opened and closed again since the last poll is
  /// reported as open once, so that the scan under way ends.
  [[nodiscard]] GpioOrders poll(hal::Stamp now) noexcept;

  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(GpioInputEvent event) const noexcept { return counters_[event]; }

 private:
  [[nodiscard]] bool was_triggered(hal::Stamp now) noexcept;
  [[nodiscard]] bool is_open(hal::Stamp now) noexcept;

  GpioInputLines lines_;
  bool was_open_ = false;
  hal::EventCounters<GpioInputEvent, kGpioInputEvents> counters_;
};

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
  hal::EventCounters<GpioOutputEvent, kGpioOutputEvents> counters_;
};

/// How a panel gets its lines: the kernel's, or whatever stands in for them.
struct GpioOpeners {
  std::function<tl::expected<std::unique_ptr<hal::GpioInput>, hal::InitError>(const hal::GpioInputConfig&)>
      input = hal::open_gpio_input;
  std::function<tl::expected<std::unique_ptr<hal::GpioOutput>, hal::InitError>(const hal::GpioOutputConfig&)>
      output = hal::open_gpio_output;
};

/// The lines of a GPIO chip that the sensor has to the outer world. Its two halves share nothing: the inputs
/// are the scan thread's, the outputs the publish thread's.
class GpioPanel {
 public:
  /// The lines that `config` names, LED and pulse dark. The error says which setting, chip and line, and what
  /// to do. A panel without any line does nothing.
  [[nodiscard]] static tl::expected<std::unique_ptr<GpioPanel>, hal::InitError> open(
      const GpioConfig& config, const GpioOpeners& openers = {});

  [[nodiscard]] GpioInputs& inputs() noexcept { return inputs_; }
  [[nodiscard]] GpioOutputs& outputs() noexcept { return outputs_; }

 private:
  GpioPanel(GpioInputLines inputs, GpioOutputLines outputs, hal::Stamp pulse) noexcept;

  GpioInputs inputs_;
  GpioOutputs outputs_;
};

}  // namespace slamsensor::firmware
