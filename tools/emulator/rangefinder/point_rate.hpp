#pragma once

#include "tools/emulator/rangefinder/point_format.hpp"

#include <cstddef>
#include <cstdint>

namespace slamsensor::tools {

/// Most readings per second at `baud` for a record of `bytes` bytes (LDS70A manual, table 7; binary records
/// of more than two bytes in proportion).
[[nodiscard]] double lds70a_rate_max_hz(std::uint32_t baud, PointCoding coding, std::size_t bytes);

}  // namespace slamsensor::tools
