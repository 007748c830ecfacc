#pragma once

#include "firmware/status/sensor_status.hpp"

#include <string>

namespace slamsensor::firmware {

/// "fix x=12.34 m y=-5.60 m heading=87.1 deg, 23 of 30 landmarks", or why there is none.
[[nodiscard]] std::string fix_phrase(const core::Fix& fix);

/// What systemctl status shows: the fix, the map, each device, what is in the way; one line.
[[nodiscard]] std::string status_line(const SensorStatus& status);

}  // namespace slamsensor::firmware
