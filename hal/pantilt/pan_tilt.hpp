#pragma once

#include "hal/device.hpp"
#include "hal/fixed_text.hpp"
#include "hal/pantilt/motion_profile.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::hal {

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

  /// Moves the oldest reported positions into `into` and returns how many. A moving axis is polled at the
  /// configured rate, a resting one slowly. Those nobody takes are dropped, oldest kept, and counted
  /// ("positions_dropped").
  [[nodiscard]] virtual std::size_t take(std::span<AxisSample> into) noexcept = 0;
};

/// Positions a driver keeps for its caller: 5 s at 50 Hz.
inline constexpr std::size_t kAxisSamplesMax = 256;

}  // namespace slamsensor::hal
