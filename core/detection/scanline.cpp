#include "core/detection/scanline.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

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

namespace {

// Distances of columns without one, so that the smaller always wins: a distance beats infinite beats empty.
constexpr double kInfinite_m = std::numeric_limits<double>::max();
constexpr double kEmpty_m = std::numeric_limits<double>::infinity();

// Angles this close are the same but for the rounding of their units.
constexpr double kSameAngle_rad = 1e-9;
constexpr double kUpright_rad = 0.5 * std::numbers::pi + kSameAngle_rad;

bool is_tilt(double tilt_rad) noexcept {
  return std::abs(tilt_rad) <= kUpright_rad;  // false for NaN
}

/// What is left of the scanline without floor(share * n) readings at each end; the slack lets 0.29 * 100
/// be 29.
std::span<const Reading> without_ends(std::span<const Reading> scanline, double share) noexcept {
  const double dropped = std::floor(share * static_cast<double>(scanline.size()) + 1e-9);
  if (!(dropped > 0.0)) {
    return scanline;
  }
  if (2.0 * dropped >= static_cast<double>(scanline.size())) {
    return {};
  }
  const auto each = static_cast<std::size_t>(dropped);
  return scanline.subspan(each, scanline.size() - 2 * each);
}

/// Mean tilt, exact when all are the same; NaN when no reading has one.
double mean_tilt_rad(std::span<const Reading> readings) noexcept {
  double first_rad = 0.0;
  double sum_rad = 0.0;
  std::size_t count = 0;
  for (const Reading& reading : readings) {
    if (!is_tilt(reading.tilt_rad)) {
      continue;
    }
    first_rad = count == 0 ? reading.tilt_rad : first_rad;
    sum_rad += reading.tilt_rad - first_rad;
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : first_rad + sum_rad / static_cast<double>(count);
}

bool is_range(double range_m) noexcept {
  return (range_m >= 0.0 && range_m <= std::numeric_limits<double>::max()) || range_m == Reading::kNoReturn;
}

/// The reading's distance from the sensor's axis; kInfinite_m without a return in range, kEmpty_m for the
/// carrier.
double distance_m(const DetectionConfig& config, double range_m, double cos_tilt) noexcept {
  if (range_m == Reading::kNoReturn || range_m > config.range_max_m) {
    return kInfinite_m;
  }
  return range_m < config.range_min_m ? kEmpty_m : range_m * cos_tilt;
}

}  // namespace

ScanlineGrid::ScanlineGrid(Arena& arena, const DetectionConfig& config) noexcept
    : config_(config),
      grid_(config),
      nearest_(arena.take<Nearest>("scanline nearest readings", grid_.columns())),
      d_cells_(arena.take<std::int32_t>("scanline distances", grid_.columns())),
      unobstructed_(arena.take<std::uint32_t>("scanline unobstructed columns", grid_.columns())),
      sightings_(arena, "scanline sightings", grid_.columns()) {
}

std::span<const Sighting> ScanlineGrid::sightings(std::span<const Reading> scanline) noexcept {
  sightings_.clear();
  const std::span<const Reading> readings = without_ends(scanline, config_.discard_share);
  const double tilt_rad = mean_tilt_rad(readings);
  left_out_ = !(tilt_rad >= config_.tilt_min_rad - kSameAngle_rad &&
                tilt_rad <= config_.tilt_max_rad + kSameAngle_rad);
  if (left_out_) {
    return {};
  }
  fold(readings);
  quantise();
  const std::size_t found = find_unobstructed(row(), {unobstructed_, grid_.columns()});
  for (std::size_t i = 0; i < found; ++i) {
    const std::uint32_t column = unobstructed_[i];
    const Nearest& nearest = nearest_[column];
    const auto row = static_cast<std::uint32_t>(d_cells_[column]);
    // Never full: a column is found at most once.
    SLAMSENSOR_ASSERT(sightings_.try_push_back({row, column, nearest.horizontal_m, nearest.bearing_rad}));
  }
  return sightings_.span();
}

void ScanlineGrid::fold(std::span<const Reading> readings) noexcept {
  std::fill_n(nearest_, grid_.columns(), Nearest{kEmpty_m, 0.0});
  double tilt_rad = std::numeric_limits<double>::quiet_NaN();
  double cos_tilt = 0.0;
  for (const Reading& reading : readings) {
    if (!std::isfinite(reading.pan_rad) || !is_tilt(reading.tilt_rad) || !is_range(reading.range_m))
        [[unlikely]] {
      ++readings_refused_;
      continue;
    }
    if (reading.tilt_rad != tilt_rad) {
      tilt_rad = reading.tilt_rad;
      cos_tilt = std::max(0.0, std::cos(tilt_rad));
    }
    keep_nearest(reading, distance_m(config_, reading.range_m, cos_tilt));
  }
}

void ScanlineGrid::keep_nearest(const Reading& reading, double horizontal_m) noexcept {
  const std::uint32_t column = grid_.column_of(reading.pan_rad);
  Nearest& nearest = nearest_[column];
  if (horizontal_m < nearest.horizontal_m) {
    nearest = {horizontal_m, reading.pan_rad};
  } else if (horizontal_m == nearest.horizontal_m && horizontal_m < kInfinite_m) {
    // Ranges in whole centimetres tie often. The one nearest the middle of the column favours neither side,
    // nor the direction of the sweep.
    const double offset_rad = grid_.off_centre_rad(column, reading.pan_rad);
    const double kept_rad = grid_.off_centre_rad(column, nearest.bearing_rad);
    const double gain_rad = std::abs(kept_rad) - std::abs(offset_rad);
    if (gain_rad > 0.0 || (gain_rad == 0.0 && offset_rad < kept_rad)) {
      nearest.bearing_rad = reading.pan_rad;
    }
  }
}

void ScanlineGrid::quantise() noexcept {
  for (std::uint32_t column = 0; column < grid_.columns(); ++column) {
    const double horizontal_m = nearest_[column].horizontal_m;
    if (horizontal_m < kInfinite_m) {
      d_cells_[column] = static_cast<std::int32_t>(grid_.row_of(horizontal_m));
    } else {
      d_cells_[column] = horizontal_m == kInfinite_m ? kInfiniteColumn : kEmptyColumn;
    }
  }
}

}  // namespace slamsensor::core
