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

/// Whether a line took its level.
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

  /// The level that was set last.
  [[nodiscard]] virtual GpioLevel level() const noexcept = 0;
};

[[nodiscard]] constexpr GpioLevel level_after(GpioEdge edge) noexcept {
  return edge == GpioEdge::ToActive ? GpioLevel::Active : GpioLevel::Inactive;
}

[[nodiscard]] constexpr GpioEdge edge_to(GpioLevel level) noexcept {
  return level == GpioLevel::Active ? GpioEdge::ToActive : GpioEdge::ToInactive;
}

/// Lets a change of level pass once the line has kept the new level for a time; what comes and goes sooner is
/// bouncing. The change is stamped with the last bounce, when the level changed for good.
class Debouncer {
 public:
  /// `period` is not negative; zero lets every change pass.
  Debouncer(Stamp period, GpioLevel level) noexcept : period_(period), settled_(level), last_(level) {}

  /// Takes the line's next edge; hands out the change that had settled before it.
  [[nodiscard]] std::optional<GpioEvent> take(const GpioEvent& edge) noexcept {
    const std::optional<GpioEvent> before = settle(edge.stamp);
    last_ = level_after(edge.edge);
    changed_ = edge.stamp;
    return before;
  }

  /// Hands out the change that has settled by `now`.
  [[nodiscard]] std::optional<GpioEvent> settle(Stamp now) noexcept {
    if (last_ == settled_ || now - changed_ < period_) {
      return std::nullopt;
    }
    settled_ = last_;
    return GpioEvent{edge_to(settled_), changed_};
  }

  [[nodiscard]] GpioLevel settled() const noexcept { return settled_; }

  /// The level after the last edge.
  [[nodiscard]] GpioLevel last() const noexcept { return last_; }

 private:
  Stamp period_;
  GpioLevel settled_;
  GpioLevel last_;
  Stamp changed_{};
};

}  // namespace slamsensor::hal
