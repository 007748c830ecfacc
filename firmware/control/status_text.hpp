#pragma once

#include "firmware/status/sensor_status.hpp"

#include <string>
#include <vector>

namespace slamsensor::firmware {

/// For people: lines of "name: value unit". Machines take the JSON (status_json).
[[nodiscard]] std::vector<std::string> status_text(const SensorStatus& status);
[[nodiscard]] std::vector<std::string> fix_text(const SensorStatus& status);
[[nodiscard]] std::vector<std::string> devices_text(const SensorStatus& status);

/// "pan_tilt.replies_lost 3": a line per counter.
[[nodiscard]] std::vector<std::string> counters_text(const SensorStatus& status);

}  // namespace slamsensor::firmware
