#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/stamp.hpp"

#include <cstdint>

namespace slamsensor::firmware {

enum class AxisMoveState : std::uint8_t {
  Asking,   ///< the unit has not taken the move yet
  Moving,   ///< taken; the axis is under way
  Arrived,  ///< polls show the axis at rest at the target
  Refused,  ///< the unit cannot go there
  Stalled,  ///< not there in time, or at rest elsewhere
};

/// One move of one axis, asked for until it is taken and watched until it has ended. A value.
class AxisMove {
 public:
  /// No move: Arrived.
  AxisMove() noexcept = default;

  /// A move to `target_rad` that may take `margin` longer than the unit's motion model says. An axis that
  /// rests there already has arrived.
  AxisMove(hal::Axis axis, double target_rad, double speed_radps, hal::Stamp margin) noexcept;

  /// Asks `unit`, which is Ready, or looks whether it has arrived.
  AxisMoveState step(hal::PanTilt& unit, hal::Stamp now) noexcept;

  [[nodiscard]] AxisMoveState state() const noexcept { return state_; }
  [[nodiscard]] hal::Axis axis() const noexcept { return axis_; }
  [[nodiscard]] double target_rad() const noexcept { return target_rad_; }
  [[nodiscard]] double speed_radps() const noexcept { return speed_radps_; }
  /// Where the axis stood when the move was asked for, where it was seen last, and how long after that.
  [[nodiscard]] double start_rad() const noexcept { return start_rad_; }
  [[nodiscard]] double seen_rad() const noexcept { return seen_rad_; }
  [[nodiscard]] hal::Stamp waited() const noexcept { return waited_; }

 private:
  void ask(hal::PanTilt& unit, hal::Stamp now) noexcept;
  void watch(const hal::AxisStatus& status, double resolution_rad, hal::Stamp now) noexcept;

  hal::Axis axis_ = hal::Axis::Pan;
  double target_rad_ = 0.0;
  double speed_radps_ = 0.0;
  hal::Stamp margin_{};
  AxisMoveState state_ = AxisMoveState::Arrived;
  double start_rad_ = 0.0;
  double seen_rad_ = 0.0;
  hal::Stamp asked_{};
  hal::Stamp waited_{};
  hal::Stamp taken_{};
  hal::Stamp deadline_ = hal::kNever;
  bool has_moved_ = false;
};

}  // namespace slamsensor::firmware
