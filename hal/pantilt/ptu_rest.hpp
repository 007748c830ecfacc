#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::hal {

/// Finds out that both axes rest: their positions stay the same over several rounds of polls, without a limit
/// report in between (a reset drives from stop to stop, and may hold an axis still for a while).
class PtuRest {
 public:
  void restart() noexcept;

  /// The axis to ask next: they take turns.
  [[nodiscard]] Axis next() const noexcept { return next_; }

  void answer(std::int32_t position) noexcept;

  /// Something says that an axis moves.
  void disturb() noexcept { rounds_ = 0; }

  [[nodiscard]] bool resting() const noexcept;
  [[nodiscard]] std::int32_t position(Axis axis) const noexcept {
    return positions_[static_cast<std::size_t>(axis)];
  }

 private:
  std::array<std::int32_t, 2> positions_{};
  Axis next_ = Axis::Pan;
  int rounds_ = 0;  // answers in a row that were as before
};

}  // namespace slamsensor::hal
