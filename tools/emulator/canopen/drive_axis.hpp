#pragma once

#include "tools/emulator/canopen/drive_profile.hpp"
#include "tools/emulator/canopen/drive_settings.hpp"
#include "tools/emulator/ptu/trajectory.hpp"

namespace slamsensor::tools {

/// How fast an axis looks for its home.
struct HomingRates {
  double fast = 0.0;  ///< until the switch
  double slow = 0.0;  ///< back, to the edge or the index pulse
  double acceleration = 1.0;
};

/// The mechanics of a drive: motor, encoder, limit switches, stops. The encoder is on the motor, so what it
/// counts is true but for where it counts from.
class DriveAxis {
 public:
  explicit DriveAxis(const DriveSettings& settings);

  [[nodiscard]] double position(Stamp at) const { return motion_.position(at); }
  [[nodiscard]] double speed(Stamp at) const { return motion_.speed(at); }
  [[nodiscard]] double truth(Stamp at) const { return motion_.truth(at); }
  [[nodiscard]] bool is_moving(Stamp at) const { return motion_.still_from() > at; }
  [[nodiscard]] Stamp still_from() const { return motion_.still_from(); }

  /// When the last command is done: at rest, or at its speed.
  [[nodiscard]] Stamp settled_at() const { return settled_at_; }

  void move(Stamp at, double target, const DriveRates& rates);
  void run(Stamp at, double bound, const DriveRates& rates);
  void stop(Stamp at, double deceleration);

  /// Stands still at once: the brake holds it, or an obstacle.
  void freeze(Stamp at);

  /// Looks for home as homing method `method` says (CiA 402: 1 and 2 limit switch and index, 17 and 18 limit
  /// switch, 33 and 34 index, 35 and 37 here); false for other methods.
  [[nodiscard]] bool home(Stamp at, long method, const HomingRates& rates);

  /// Counts from now on so that it is at `position`. It rests.
  void set_position(Stamp at, double position);

  /// When it runs into a mechanical stop; kNever when it does not.
  [[nodiscard]] Stamp stop_hit() const { return hit_at_; }

  /// When the present motion would be `window` away from where it is at `at`; kNever when it ends before.
  [[nodiscard]] Stamp gets_away(Stamp at, double window) const;

  void forget(Stamp before) { motion_.forget(before); }

 private:
  void follow(Stamp at, const DriveProfile& profile);
  [[nodiscard]] DriveProfile to_switch(const StepperState& state, double edge, double direction,
                                       const HomingRates& rates) const;

  const DriveSettings& settings_;
  Trajectory motion_;
  Stamp settled_at_ = Stamp::min();
  Stamp hit_at_ = hal::kNever;
};

}  // namespace slamsensor::tools
