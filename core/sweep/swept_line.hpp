#pragma once

#include "core/reading.hpp"

#include <chrono>
#include <cstdint>
#include <span>

namespace slamsensor::core {

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
