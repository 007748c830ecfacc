#pragma once

#include "hal/device.hpp"
#include "hal/fixed_text.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

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

/// Pan: counter-clockwise seen from above positive (z' up). Tilt: up positive.
enum class Axis : std::uint8_t { Pan, Tilt };

/// What the unit said of one axis.
struct AxisInfo {
  double min_rad = 0.0;
  double max_rad = 0.0;
  double resolution_rad = 0.0;  ///< of one position
  double speed_min_radps = 0.0;
  double speed_max_radps = 0.0;
  AxisDynamics dynamics;
};

struct PanTiltInfo {
  FixedText<80> model;
  AxisInfo pan;
  AxisInfo tilt;
};

/// A position that the unit reported.
struct AxisSample {
  Stamp stamp{};       ///< best estimate of when the axis was there
  Stamp half_width{};  ///< it was there within stamp - half_width and stamp + half_width, controller latency
                       ///< apart
  double position_rad = 0.0;
  Axis axis = Axis::Pan;
};

/// How an axis stands: its last accepted move and whether it has ended.
struct AxisStatus {
  MotionProfile move;         ///< as planned from the accepted command
  Stamp begun{};              ///< about when it began (command sent, first half of the reply gap over)
  bool moving = false;        ///< false when polls have shown it at its target (or after a halt or loss)
  double position_rad = 0.0;  ///< as last polled
  Stamp polled{};             ///< when; 0 before the first poll
};

enum class MoveStatus : std::uint8_t {
  Accepted,    ///< taken by the driver; it is sent as soon as the line is free
  Busy,        ///< an earlier command of this axis is not confirmed yet; try again
  NotReady,    ///< the device is not Ready
  OutOfRange,  ///< target outside the limits or speed outside what the unit can do: nothing is sent
};

class PanTilt : public Device {
 public:
  /// Moves `axis` to `target_rad` at `speed_radps` (positive), replacing its move. A unit that answers with
  /// an error leaves the axis where it is, counts it and stops reporting it as moving.
  [[nodiscard]] virtual MoveStatus move(Axis axis, double target_rad, double speed_radps) noexcept = 0;

  /// Stops both axes as soon as the line is free.
  [[nodiscard]] virtual MoveStatus halt() noexcept = 0;

  /// Valid while Ready. When the state leaves Ready every axis is "not moving" and its position unknown until
  /// polled.
  [[nodiscard]] virtual const AxisStatus& axis(Axis axis) const noexcept = 0;
  [[nodiscard]] virtual const PanTiltInfo& info() const noexcept = 0;

  /// Why what comes over its line cannot be relied on, for a person: replies that come late or do not belong
  /// to what was asked, noise; empty while it can. A remark() too. Valid until the next step().
  [[nodiscard]] virtual std::string_view line_trouble() const noexcept { return {}; }

  /// Moves the oldest reported positions into `into` and returns how many. A moving axis is polled at the
  /// configured rate, a resting one slowly. Those nobody takes are dropped, oldest kept, and counted
  /// ("positions_dropped").
  [[nodiscard]] virtual std::size_t take(std::span<AxisSample> into) noexcept = 0;
};

/// Positions a driver keeps for its caller: 5 s at 50 Hz.
inline constexpr std::size_t kAxisSamplesMax = 256;

}  // namespace slamsensor::hal
