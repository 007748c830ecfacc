#pragma once

#include "core/config.hpp"
#include "tests/rt/walks.hpp"

#include <cstdint>

namespace slamsensor::tests {

/// Scans of readings, which the detector takes, with room for `cells` occupied cells.
[[nodiscard]] Walk readings_walk(core::LandmarkPoint point, std::uint32_t cells);

}  // namespace slamsensor::tests
