#pragma once

#include "hal/stamp.hpp"

#include <deque>
#include <span>
#include <vector>

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

/// Motion with constant acceleration for a while. Positions and seconds; speed is signed.
struct MotionLeg {
  double duration_s = 0.0;
  double speed = 0.0;  ///< at its beginning
  double acceleration = 0.0;
};

/// Legs one after the other and the place where the axis then rests.
struct MotionPlan {
  std::vector<MotionLeg> legs;
  double end = 0.0;
};

/// The fastest way from `state` to rest at `target`: a motor that goes the wrong way or too fast to stop
/// there slows down first and comes back.
[[nodiscard]] MotionPlan plan_move(StepperState state, double target, const StepperRates& rates);

/// The shortest way to rest, at the next whole position.
[[nodiscard]] MotionPlan plan_stop(const StepperState& state, const StepperRates& rates);

/// Where a motor is at every time: what its controller counts, and the true place, which differs by the slip
/// (steps that the motor missed). In positions.
class Trajectory {
 public:
  /// Rests at `position` from the beginning of time.
  explicit Trajectory(double position);

  /// From `at` on rests at `position`, `slip` beside it.
  void rest(hal::Stamp at, double position, double slip);

  /// From `at` on follows `plan` from where it is, with the slip it has.
  void follow(hal::Stamp at, const MotionPlan& plan);

  /// From `at` on the true place is `steps` further off.
  void miss(hal::Stamp at, double steps);

  /// Forgets what was before `before`.
  void forget(hal::Stamp before);

  [[nodiscard]] double position(hal::Stamp at) const;
  [[nodiscard]] double speed(hal::Stamp at) const;
  [[nodiscard]] double slip(hal::Stamp at) const { return piece(at).slip; }
  [[nodiscard]] double truth(hal::Stamp at) const { return position(at) + slip(at); }

  /// Since when, or from when on, it rests.
  [[nodiscard]] hal::Stamp still_from() const { return pieces_.back().start; }

  /// When, at `from` or later, the true place first leaves [low, high]; kNever when it does not.
  [[nodiscard]] hal::Stamp leaves(hal::Stamp from, double low, double high) const;

 private:
  struct Piece {
    hal::Stamp start = hal::Stamp::min();
    double position = 0.0;
    double speed = 0.0;
    double acceleration = 0.0;
    double slip = 0.0;
  };

  [[nodiscard]] const Piece& piece(hal::Stamp at) const;
  void cut(hal::Stamp at);

  std::deque<Piece> pieces_;  // each holds until the next begins; the last rests
};

}  // namespace slamsensor::tools
