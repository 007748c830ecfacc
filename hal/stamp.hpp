#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace slamsensor::hal {

/// A moment on CLOCK_MONOTONIC (time since boot), or a length of time.
using Stamp = std::chrono::nanoseconds;

/// Later than every moment: "never".
inline constexpr Stamp kNever = Stamp::max();

[[nodiscard]] constexpr double to_seconds(Stamp time) noexcept {
  return static_cast<double>(time.count()) * 1e-9;
}

/// `seconds` rounded to the nanosecond; its magnitude must be below 9e9 s.
[[nodiscard]] constexpr Stamp from_seconds(double seconds) noexcept {
  return Stamp(static_cast<Stamp::rep>(seconds * 1e9 + (seconds < 0.0 ? -0.5 : 0.5)));
}

/// What `bytes` take on a serial line with one start and one stop bit; `baud` is positive.
[[nodiscard]] constexpr Stamp line_time(std::size_t bytes, std::uint32_t baud) noexcept {
  return Stamp(static_cast<Stamp::rep>(bytes) * 10'000'000'000 / static_cast<Stamp::rep>(baud));
}

}  // namespace slamsensor::hal
