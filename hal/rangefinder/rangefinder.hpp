#pragma once

#include "hal/device.hpp"
#include "hal/fixed_text.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::hal {

/// What came back of one shot.
enum class Echo : std::uint8_t {
  Return,     ///< a distance
  None,       ///< nothing within range: open sky
  Weak,       ///< something, too faint to be trusted
  Saturated,  ///< something, too bright to be measured
  Fault,      ///< the device says that it did not measure
};

struct RangeSample {
  /// When the device began to send the reading, from arrival, line rate and the device's own period. It
  /// measured a constant time earlier, which is unknown here (firmware/scan finds it).
  Stamp stamp{};
  double range_m = 0.0;   ///< meaningful for Echo::Return alone, and then positive; 0 otherwise
  double strength = 0.0;  ///< in the device's unit; 0 when it tells none
  Echo echo = Echo::None;
};

struct RangefinderInfo {
  FixedText<32> product;
  double rate_hz = 0.0;  ///< readings per second that were asked for and confirmed
  double range_max_m = 0.0;
  double resolution_m = 0.0;
};

class Rangefinder : public Device {
 public:
  /// Moves the oldest readings into `into`, in the order of time, and returns how many. Those nobody takes
  /// are dropped, oldest kept, and counted ("readings_dropped").
  [[nodiscard]] virtual std::size_t take(std::span<RangeSample> into) noexcept = 0;

  /// What the device said of itself; valid while Ready.
  [[nodiscard]] virtual const RangefinderInfo& info() const noexcept = 0;
};

/// Readings a driver keeps for its caller: 0.2 s at 20 kHz.
inline constexpr std::size_t kRangeSamplesMax = 4096;

}  // namespace slamsensor::hal
