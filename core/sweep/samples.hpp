#pragma once

#include <chrono>
#include <cstdint>

namespace slamsensor::core {

[[nodiscard]] constexpr double seconds_of(std::chrono::nanoseconds time) noexcept {
  return static_cast<double>(time.count()) * 1e-9;
}

/// `seconds` rounded to the nanosecond; its magnitude must be below 9e9 s.
[[nodiscard]] constexpr std::chrono::nanoseconds from_seconds(double seconds) noexcept {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0.0 ? -0.5 : 0.5)));
}

/// What came back of a measurement of the range.
enum class EchoKind : std::uint8_t { Return, None, Weak, Saturated, Fault };

/// What the rangefinder measured, and when.
struct TimedRange {
  std::chrono::nanoseconds stamp{};
  double range_m = 0.0;  ///< of a Return alone
  EchoKind echo = EchoKind::None;
};

enum class SweepAxis : std::uint8_t { Pan, Tilt };

/// Where an axis was: within `half_width` of the stamp.
struct TimedAngle {
  std::chrono::nanoseconds stamp{};
  std::chrono::nanoseconds half_width{};
  double position_rad = 0.0;
  SweepAxis axis = SweepAxis::Pan;
};

/// One move of an axis from rest to rest as the model of the unit has it, over the time since its start. The
/// model is lent: it outlives the path.
struct AxisPath {
  using Function = double (*)(const void* model, double elapsed_s) noexcept;

  const void* model = nullptr;
  double start_rad = 0.0;
  double target_rad = 0.0;
  double duration_s = 0.0;
  Function position_rad = [](const void*, double) noexcept { return 0.0; };
  Function speed_radps = [](const void*, double) noexcept { return 0.0; };  ///< signed; 0 outside the move

  [[nodiscard]] double position_at(double elapsed_s) const noexcept { return position_rad(model, elapsed_s); }
  [[nodiscard]] double speed_at(double elapsed_s) const noexcept { return speed_radps(model, elapsed_s); }
};

}  // namespace slamsensor::core
