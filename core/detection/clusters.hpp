#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace slamsensor::core {

/// What a column of the one-row grid holds besides a row of the spiderweb (DESIGN 2.2). Nothing is lower than
/// an empty column, as nothing is lower than zero.
inline constexpr std::int32_t kEmptyColumn = -1;  ///< not looked at; counts as distance zero
inline constexpr std::int32_t kInfiniteColumn = std::numeric_limits<std::int32_t>::max();  ///< no return

/// Writes the columns of all unobstructed clusters of `row` (d_cell per column around the whole circle) to
/// `columns`, which has room for row.size(), cluster by cluster; returns how many. A cluster is a maximal
/// circular run of columns with a distance, neighbours differing by at most 1; it is unobstructed when the
/// distance at each of its two ends is lower than that of the adjoining column. A cluster that goes all the
/// way round has no ends, hides what may be behind it everywhere, and is never a landmark (a wall around the
/// sensor). Source: section II-A of the paper, Fig. 4.
[[nodiscard]] std::size_t find_unobstructed(std::span<const std::int32_t> row,
                                            std::span<std::uint32_t> columns) noexcept;

}  // namespace slamsensor::core
