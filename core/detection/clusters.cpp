#include "core/detection/clusters.hpp"

#include "core/memory/assert.hpp"

#include <cstdlib>

namespace slamsensor::core {
namespace {

using Row = std::span<const std::int32_t>;

bool has_distance(std::int32_t d_cell) noexcept {
  return d_cell != kEmptyColumn && d_cell != kInfiniteColumn;
}

std::size_t next_column(Row row, std::size_t column) noexcept {
  return column + 1 == row.size() ? 0 : column + 1;
}

std::size_t previous_column(Row row, std::size_t column) noexcept {
  return (column == 0 ? row.size() : column) - 1;
}

/// Whether `column` and the one after it belong to one cluster.
bool joins_next(Row row, std::size_t column) noexcept {
  const std::int32_t here = row[column];
  const std::int32_t there = row[next_column(row, column)];
  return has_distance(here) && has_distance(there) && std::abs(here - there) <= 1;
}

/// A column that starts a cluster or stands outside all of them; row.size() when one cluster goes all the way
/// round.
std::size_t find_start(Row row) noexcept {
  for (std::size_t column = 0; column < row.size(); ++column) {
    if (!joins_next(row, column)) {
      return next_column(row, column);
    }
  }
  return row.size();
}

bool is_unobstructed(Row row, std::size_t first, std::size_t last) noexcept {
  return row[first] < row[previous_column(row, first)] && row[last] < row[next_column(row, last)];
}

}  // namespace

std::size_t find_unobstructed(Row row, std::span<std::uint32_t> columns) noexcept {
  SLAMSENSOR_ASSERT(columns.size() >= row.size());
  const std::size_t start = find_start(row);
  if (start == row.size()) {
    return 0;
  }
  std::size_t found = 0;
  std::size_t column = start;
  for (std::size_t seen = 0; seen < row.size();) {
    const std::size_t first = column;
    std::size_t last = column;
    // Ends at the latest before `start`, which does not join its predecessor.
    while (joins_next(row, last)) {
      last = next_column(row, last);
    }
    const std::size_t end = next_column(row, last);
    const bool kept = has_distance(row[first]) && is_unobstructed(row, first, last);
    do {
      if (kept) {
        columns[found++] = static_cast<std::uint32_t>(column);
      }
      column = next_column(row, column);
      ++seen;
    } while (column != end);
  }
  return found;
}

}  // namespace slamsensor::core
