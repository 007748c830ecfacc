#pragma once

namespace slamsensor::hal {

/// How an axis gets up to speed: at once to the base speed, from there with constant acceleration (PTU-D46
/// User's Manual 2.14, "Motion control"). A base speed of 0 is a pure trapezoid (CiA 402 profile position).
struct AxisDynamics {
  double base_speed_radps = 0.0;
  double acceleration_radps2 = 0.0;  ///< 0: the axis never runs faster than its base speed
};

/// One move of one axis from rest to rest: constant speed at or below the base speed, else a symmetric
/// trapezoid on top of it, which becomes a triangle when the way is too short. A value.
class MotionProfile {
 public:
  /// No move: rests at 0.
  MotionProfile() noexcept = default;

  /// The move from `start_rad` to `target_rad` at `speed_radps` (positive).
  MotionProfile(double start_rad, double target_rad, double speed_radps,
                const AxisDynamics& dynamics) noexcept;

  /// Position `elapsed_s` after the start: the start before it, the target from duration_s() on.
  [[nodiscard]] double position_rad(double elapsed_s) const noexcept;

  /// Signed speed at `elapsed_s`; 0 outside the move. At the edges of a jump, the speed after it.
  [[nodiscard]] double speed_radps(double elapsed_s) const noexcept;

  /// How long after the start the move passes `position_rad`: 0 for the start and what lies before it,
  /// duration_s() for the target and what lies beyond.
  [[nodiscard]] double elapsed_s(double position_rad) const noexcept;

  [[nodiscard]] double duration_s() const noexcept { return 2.0 * ramp_s_ + cruise_s_; }
  [[nodiscard]] double start_rad() const noexcept { return start_rad_; }
  [[nodiscard]] double target_rad() const noexcept { return start_rad_ + sign_ * length_rad_; }

 private:
  [[nodiscard]] double ramped_rad(double ramp_s) const noexcept;
  [[nodiscard]] double ramp_of_s(double way_rad) const noexcept;

  double start_rad_ = 0.0;
  double length_rad_ = 0.0;  // of the way, positive
  double sign_ = 1.0;
  double base_radps_ = 0.0;    // speed at the start of the ramp
  double cruise_radps_ = 0.0;  // speed reached
  double acceleration_radps2_ = 0.0;
  double ramp_s_ = 0.0;  // of each of the two ramps
  double cruise_s_ = 0.0;
};

}  // namespace slamsensor::hal
