#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/world/random.hpp"

#include <cstdint>

namespace slamsensor::tools {

/// Draws the delays of one kind, one after the other.
class DelayDraw {
 public:
  DelayDraw(const Delay& delay, std::uint64_t seed) : delay_(delay), rng_(seed) {}

  /// A new delay: constant plus normal jitter cut at 4 standard deviations, at least 0. Draws nothing without
  /// jitter.
  [[nodiscard]] Stamp draw();

 private:
  Delay delay_;
  Random rng_;
};

}  // namespace slamsensor::tools
