#pragma once

#include "tools/top/sensor_view.hpp"
#include "tools/top/text_line.hpp"

namespace slamsensor::tools {

/// State, fix, sensor head, devices, SLAM and map of `view` as lines for a person.
[[nodiscard]] TextLines sensor_lines(const SensorView& view, hal::Stamp now);

/// Every counter that is not 0, by station, those that grew within the last 10 s marked; how many are 0.
[[nodiscard]] TextLines counter_lines(const SensorView& view, hal::Stamp now);

}  // namespace slamsensor::tools
