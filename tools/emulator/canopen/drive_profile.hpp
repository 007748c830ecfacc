#pragma once

#include "tools/emulator/ptu/motion_plan.hpp"

namespace slamsensor::tools {

/// How a drive moves: never faster than `speed`, with ramps of their own up and down (CiA 402, linear ramp
/// profile). Counts/s and counts/s^2, all positive.
struct DriveRates {
  double speed = 0.0;
  double acceleration = 1.0;
  double deceleration = 1.0;
};

/// A motion and when, from its begin, it has settled: at rest, or at its speed.
struct DriveProfile {
  MotionPlan plan;
  double settled_s = 0.0;
};

/// The fastest way from `state` to rest at `target`; settled at its end.
[[nodiscard]] DriveProfile plan_profile(StepperState state, double target, const DriveRates& rates);

/// At the speed of `rates` towards `bound`, where it stops; settled when the speed is reached.
[[nodiscard]] DriveProfile plan_run(const StepperState& state, double bound, const DriveRates& rates);

/// The shortest way to rest.
[[nodiscard]] DriveProfile plan_rest(const StepperState& state, double deceleration);

/// `second`, which begins where `first` ends, right after it.
[[nodiscard]] DriveProfile then(DriveProfile first, const DriveProfile& second);

}  // namespace slamsensor::tools
