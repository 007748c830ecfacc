#pragma once

#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::hal {

/// Level of a line as its user means it: Active is high, or low on an active-low line.
enum class GpioLevel : std::uint8_t { Inactive, Active };

/// A change of level, as its user means it.
enum class GpioEdge : std::uint8_t { ToActive, ToInactive };

struct GpioEvent {
  GpioEdge edge = GpioEdge::ToActive;
  Stamp stamp{};  ///< when the level changed, the kernel's time; of a debounced line: changed for good
};

enum class GpioBias : std::uint8_t { AsIs, Disabled, PullUp, PullDown };
enum class GpioPolarity : std::uint8_t { ActiveHigh, ActiveLow };

/// Which edges an input reports.
enum class GpioEdges : std::uint8_t { None, ToActive, ToInactive, Both };

/// An input line. No waiting. One thread.
class GpioInput {
 public:
  GpioInput() = default;
  GpioInput(const GpioInput&) = delete;
  GpioInput& operator=(const GpioInput&) = delete;
  virtual ~GpioInput() = default;

  /// The level at `now`, debounced when the line is; nothing when the line cannot be read (its chip is gone).
  [[nodiscard]] virtual std::optional<GpioLevel> level(Stamp now) noexcept = 0;

  /// Takes the oldest edge of the configured kind; nothing when there was none up to `now`. An edge of a
  /// debounced line is there once the line has kept its new level for the debounce time.
  [[nodiscard]] virtual std::optional<GpioEvent> next_event(Stamp now) noexcept = 0;

  /// What to wait on with poll() until something changes; -1 when the line reports nothing or has no
  /// descriptor. A debounced line may have its event only the debounce time after.
  [[nodiscard]] virtual int fd() const noexcept = 0;

  [[nodiscard]] virtual std::span<const Counter> counters() const noexcept = 0;
};

/// Whether a line took what it was told.
enum class GpioStatus : std::uint8_t { Ok, Failed };

/// An output line. No waiting. One thread.
class GpioOutput {
 public:
  GpioOutput() = default;
  GpioOutput(const GpioOutput&) = delete;
  GpioOutput& operator=(const GpioOutput&) = delete;
  virtual ~GpioOutput() = default;

  /// Failed, and the line as it was, when its chip is gone.
  virtual GpioStatus set(GpioLevel level) noexcept = 0;

  /// What the line was told last.
  [[nodiscard]] virtual GpioLevel level() const noexcept = 0;
};

}  // namespace slamsensor::hal
