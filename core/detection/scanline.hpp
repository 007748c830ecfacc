#pragma once

#include "core/config.hpp"
#include "core/detection/polar_grid.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"
#include "core/reading.hpp"

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

/// A cell of the spiderweb in which a scanline sees an unobstructed cluster, and the nearest reading of its
/// column.
struct Sighting {
  std::uint32_t row;
  std::uint32_t column;
  double horizontal_m;  ///< d cos(phi'), from the sensor's axis
  double bearing_rad;   ///< theta' as it was read
};

/// The scanline algorithm of DESIGN 2.2 (the paper's section II-A): a temporary grid of one row that keeps
/// the nearest distance per column, and its clusters. No allocation after construction; one thread.
///
/// How a reading counts: no return, or a range beyond range_max, makes its column infinite; a return nearer
/// than range_min is the carrier and leaves its column as it was; every other return offers a distance. The
/// smallest distance wins, a distance beats infinite, infinite beats empty, so that the order of the readings
/// is immaterial. A bearing or tilt that is not finite, a tilt beyond +-90 deg, and a range that is NaN,
/// infinite or negative (other than kNoReturn) refuse the reading, which is counted and changes nothing else.
class ScanlineGrid {
 public:
  ScanlineGrid(Arena& arena, const DetectionConfig& config) noexcept;

  /// The unobstructed cells of one scanline, at most one per column, valid until the next call.
  /// floor(discard_share * n) readings are left out at each end; nothing is seen when the mean tilt of the
  /// rest, rounding allowed for, is outside [tilt_min, tilt_max]. Tilts may differ within a scanline, as
  /// levelled lidar rings do; it is cheaper when they do not.
  [[nodiscard]] std::span<const Sighting> sightings(std::span<const Reading> scanline) noexcept;

  /// d_cell per column of the last scanline that was not left out: a row of the spiderweb, kEmptyColumn or
  /// kInfiniteColumn.
  [[nodiscard]] std::span<const std::int32_t> row() const noexcept { return {d_cells_, grid_.columns()}; }

  /// Whether the last scanline was left out: outside the tilts that are looked at, or too short.
  [[nodiscard]] bool left_out() const noexcept { return left_out_; }

  /// Readings refused since construction.
  [[nodiscard]] std::uint64_t readings_refused() const noexcept { return readings_refused_; }

 private:
  struct Nearest {
    double horizontal_m;
    double bearing_rad;
  };

  void fold(std::span<const Reading> readings) noexcept;
  void keep_nearest(const Reading& reading, double horizontal_m) noexcept;
  void quantise() noexcept;

  DetectionConfig config_;
  PolarGrid grid_;
  Nearest* nearest_;       // per column
  std::int32_t* d_cells_;  // per column
  std::uint32_t* unobstructed_;
  BoundedVector<Sighting> sightings_;
  std::uint64_t readings_refused_ = 0;
  bool left_out_ = true;
};

}  // namespace slamsensor::core
