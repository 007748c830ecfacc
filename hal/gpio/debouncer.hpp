#pragma once

#include "hal/gpio/gpio.hpp"
#include "hal/stamp.hpp"

#include <optional>

namespace slamsensor::hal {

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
