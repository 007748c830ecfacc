#pragma once

#include "core/reading.hpp"
#include "firmware/scan/scan_config.hpp"
#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// The scanlines of one scan of readings (`pan_deg,tilt_deg,range_m[,roll_deg,pitch_deg]` in any order; an
/// empty range is no return), in the order of the file: consecutive rows with the same text for a tilt are
/// one scanline. At least one reading. An error, with the line, for anything that is not a number, pan beyond
/// +-360 deg, tilt beyond +-90 deg, a range below 0 or beyond kInputReach_m, a column missing, unknown or
/// twice, or a row of another width than the header.
///
/// Readings of a file with `roll_deg,pitch_deg` (core::Attitude, of the sensor) are levelled by them, those
/// of another by the fixed attitude of `levelling`; when that asks for an inclinometer, such a file is
/// refused.
[[nodiscard]] tl::expected<std::vector<std::vector<core::Reading>>, InputError> parse_readings_csv(
    std::string_view text, std::string_view name, const firmware::LevellingConfig& levelling = {});

}  // namespace slamsensor::tools
