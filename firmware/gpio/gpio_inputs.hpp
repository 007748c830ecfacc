#pragma once

#include "hal/counters.hpp"
#include "hal/gpio/gpio.hpp"
#include "hal/stamp.hpp"

#include <cstddef>
#include <cstdint>
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
  /// told as open once, so that the scan under way ends.
  [[nodiscard]] GpioOrders poll(hal::Stamp now) noexcept;

  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(GpioInputEvent event) const noexcept { return counters_[event]; }

 private:
  [[nodiscard]] bool was_triggered(hal::Stamp now) noexcept;
  [[nodiscard]] bool is_open(hal::Stamp now) noexcept;

  GpioInputLines lines_;
  bool was_open_ = false;
  hal::Counters<GpioInputEvent, kGpioInputEvents> counters_;
};

}  // namespace slamsensor::firmware
