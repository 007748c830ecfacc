#pragma once

#include "tools/emulator/ptu/trajectory.hpp"

namespace slamsensor::tools {

/// How fast a stepper axis may go (PTU-D46 User's Manual, "Axis speed and acceleration"): up to the base
/// speed it starts, stops and turns at once, above it speeds up and slows down with the acceleration.
/// Positions/s and positions/s^2, all positive.
struct StepperRates {
  double speed = 0.0;
  double base = 0.0;
  double acceleration = 0.0;
};

/// Where a motor is and how fast it goes, signed.
struct StepperState {
  double position = 0.0;
  double speed = 0.0;
};

/// The fastest way from `state` to rest at `target`: a motor that goes the wrong way or too fast to stop
/// there slows down first and comes back.
[[nodiscard]] MotionPlan plan_move(StepperState state, double target, const StepperRates& rates);

/// The shortest way to rest, at the next whole position.
[[nodiscard]] MotionPlan plan_stop(const StepperState& state, const StepperRates& rates);

}  // namespace slamsensor::tools
