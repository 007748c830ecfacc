#pragma once

#include "firmware/status/sensor_status.hpp"

#include <string>
#include <vector>

namespace slamsensor::firmware {

/// The status as one line of JSON. Units stand in the names of the members; what is not known is null.
/// Members are only ever added.
[[nodiscard]] std::string status_json(const SensorStatus& status);

/// Its last fix: all that core::Fix has; the pose and its errors are null without a fix, and those of the
/// better place with an ambiguous one. Times are of the scan, UTC, ns since 1970.
[[nodiscard]] std::string fix_json(const SensorStatus& status);

/// {"pan_tilt": {"name": n, ...}, "rangefinder": ..., "head": ..., "slam": ..., "outputs": ...}
[[nodiscard]] std::string counters_json(const SensorStatus& status);

/// {"pan_tilt": {...}, "rangefinder": {...}}
[[nodiscard]] std::string devices_json(const SensorStatus& status);

/// For people: lines of "name: value unit". Machines take the JSON (status_json).
[[nodiscard]] std::vector<std::string> status_text(const SensorStatus& status);
[[nodiscard]] std::vector<std::string> fix_text(const SensorStatus& status);
[[nodiscard]] std::vector<std::string> devices_text(const SensorStatus& status);

/// "pan_tilt.replies_lost 3": a line per counter.
[[nodiscard]] std::vector<std::string> counters_text(const SensorStatus& status);

}  // namespace slamsensor::firmware
