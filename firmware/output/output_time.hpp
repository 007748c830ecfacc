#pragma once

#include "hal/stamp.hpp"

#include <chrono>

namespace slamsensor::firmware {

/// One moment on both clocks.
struct OutputTime {
  hal::Stamp monotonic{};
  std::chrono::nanoseconds utc{0};  ///< since 1970-01-01, as the system's clock has it
};

}  // namespace slamsensor::firmware
