#pragma once

#include "core/reading.hpp"

#include <chrono>
#include <cstdint>
#include <span>

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

enum class SweepDirection : std::uint8_t {
  Leftwards,   ///< counter-clockwise: pan grows
  Rightwards,  ///< pan falls
};

/// One sweep of the pan axis at one tilt: where the names of hal end. The spans are the assembler's and valid
/// until it begins the next line.
struct Scanline {
  std::span<const Reading> readings;                 ///< in the order of time
  std::span<const std::chrono::nanoseconds> stamps;  ///< of each reading, as the rangefinder's driver told it
  double tilt_rad = 0.0;                             ///< as the resting axis reported it
  SweepDirection direction = SweepDirection::Leftwards;
  double pan_sigma_rad =
      0.0;  ///< 1 sigma of a reading's pan, the latency's and a change of half_width_s included
  std::uint32_t line = 0;       ///< number within its scan (or calibration pass), from 0
  double pan_radps = 0.0;       ///< speed of the steady part, positive
  double steady_min_rad = 0.0;  ///< between these the pan ran at that speed
  double steady_max_rad = 0.0;
  double fit_sigma_s = 0.0;   ///< 1 sigma of the pan fit in the middle of the line, as a time
  double half_width_s = 0.0;  ///< median of the polls': the axis was at a place within this of the stamp
  double latency_s = 0.0;     ///< that was added to the stamps to tell pan from them
};

}  // namespace slamsensor::core
