#pragma once

#include "core/reading.hpp"

#include <cstddef>
#include <vector>

namespace slamsensor::bench {

/// Scanlines of a scan.
using Scan = std::vector<std::vector<core::Reading>>;

/// Scans of the paper's size (51 scanlines of 5,000 readings) from `count` stands in the simulated bush
/// world. Ends the program with a message when the world cannot be loaded.
[[nodiscard]] std::vector<Scan> bush_scans(std::size_t count);

/// Of the paper's size: every other column holds one cell of its own in every scanline, so that there are as
/// many landmarks to be as the sweep can show. Ranges vary within the cell from reading to reading.
[[nodiscard]] Scan most_groups_scan();

/// Of the paper's size: every column but each hundredth holds a cell of its own in every scanline, so that as
/// many cells are occupied as the sweep can show, in large groups.
[[nodiscard]] Scan most_cells_scan();

/// Of the paper's size: every reading a tilt of its own (a levelled sensor), and either nothing or any range
/// there is. No branch can be foreseen.
[[nodiscard]] Scan noise_scan();

}  // namespace slamsensor::bench
