#pragma once

#include "hal/stamp.hpp"

namespace slamsensor::hal {

/// CLOCK_MONOTONIC now. Only transports (which stamp what arrives) and thread loops ask; everything else gets
/// the time as an argument.
[[nodiscard]] Stamp monotonic_now() noexcept;

/// By how much CLOCK_REALTIME is ahead of CLOCK_MONOTONIC now, as read within the shortest of three moments.
[[nodiscard]] Stamp realtime_ahead() noexcept;

}  // namespace slamsensor::hal
