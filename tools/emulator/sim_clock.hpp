#pragma once

#include "hal/stamp.hpp"

namespace slamsensor::tools {

/// The time of an in-process run. Whoever runs the loop moves it, never backwards.
struct SimClock {
  hal::Stamp now{};
};

}  // namespace slamsensor::tools
