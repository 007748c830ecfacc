#pragma once

#include "core/reading.hpp"
#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// The scanlines of one scan of readings (`pan_deg,tilt_deg,range_m` in any order; an empty range is no
/// return), in the order of the file: consecutive rows with the same text for a tilt are one scanline. At
/// least one reading. An error, with the line, for anything that is not a number, pan beyond +-360 deg, tilt
/// beyond +-90 deg, a range below 0 or beyond kInputReach_m, a column missing, unknown or twice, or a row of
/// another width than the header.
[[nodiscard]] tl::expected<std::vector<std::vector<core::Reading>>, InputError> parse_readings_csv(
    std::string_view text, std::string_view name);

}  // namespace slamsensor::tools
