#pragma once

#include "core/config.hpp"
#include "core/detection/polar_grid.hpp"
#include "core/detection/scanline.hpp"
#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// A connected group of occupied cells: a landmark to be.
struct CellGroup {
  std::uint32_t begin = 0;  ///< where its cells start in Spiderweb's list
  std::uint32_t size = 0;   ///< number of cells
  std::uint64_t count = 0;  ///< total count of the cells
  std::uint32_t nearest_cell =
      0;                 ///< its innermost cell, of those the one with the lowest column; no group shares it
  double sum_x_m = 0.0;  ///< of the readings in its cells, when the spiderweb keeps them
  double sum_y_m = 0.0;
  double sum_columns = 0.0;   ///< over the count: columns from the first cell on, to the left positive ...
  double sum_columns2 = 0.0;  ///< ... and their squares

  /// How many columns it is wide: so many that are equally full have the variance of its columns.
  [[nodiscard]] double columns_wide() const noexcept {
    const auto n = static_cast<double>(count);
    const double mean = sum_columns / n;
    return std::sqrt(12.0 * std::max(0.0, sum_columns2 / n - mean * mean) + 1.0);
  }
  /// Mean number of scanlines that see a cell of the group: how tall it stands.
  [[nodiscard]] double weight() const noexcept {
    return static_cast<double>(count) / static_cast<double>(size);
  }
};

/// The spiderweb grid of DESIGN 2.2 (the paper's section II-A): how many scanlines saw something unobstructed
/// in each polar cell, with a list of the occupied cells so that no step costs more than they are. A cell has
/// the index row * columns + column. No allocation after construction; one thread.
class Spiderweb {
 public:
  /// Room for `cells_max` occupied cells, or for all there are if those are fewer. Readings are summed per
  /// cell only for LandmarkPoint::ReadingMean.
  Spiderweb(Arena& arena, const DetectionConfig& config, std::uint32_t cells_max) noexcept;

  /// Counts a scanline's sighting in its cell. When the cell would be one more than there is room for, it is
  /// dropped and counted as such; cells already in the list go on counting.
  void add(const Sighting& sighting) noexcept;

  /// Puts the heaviest groups into `heaviest`, heaviest first, as many as it has room for, and empties the
  /// grid. Groups are 8-connected, column 0 adjoining the last: adjacent columns of a cluster may differ by a
  /// row. Of equal weights the one with the nearer innermost cell comes first, then the one with the smaller
  /// bearing of that cell.
  void take_heaviest(BoundedVector<CellGroup>& heaviest) noexcept;

  /// The cell indices of a group, valid until the next take_heaviest().
  [[nodiscard]] std::span<const std::uint32_t> cells(const CellGroup& group) const noexcept;

  [[nodiscard]] const PolarGrid& grid() const noexcept { return grid_; }
  [[nodiscard]] std::size_t cells_occupied() const noexcept { return occupied_.size(); }
  /// 0 for a cell that no unobstructed cluster was seen in since the last take_heaviest().
  [[nodiscard]] std::uint32_t count(std::uint32_t row, std::uint32_t column) const noexcept;
  /// Sightings that found no room for their cell, since construction.
  [[nodiscard]] std::uint64_t cells_dropped() const noexcept { return cells_dropped_; }

 private:
  struct Occupied {
    std::uint32_t cell;
    std::uint32_t count;
  };

  [[nodiscard]] CellGroup take_group(std::uint32_t first_cell) noexcept;
  void take_cell(std::uint32_t cell, CellGroup& group) noexcept;
  void take_neighbours(std::uint32_t cell, CellGroup& group) noexcept;

  PolarGrid grid_;
  bool keeps_sums_;
  std::uint32_t* slots_;  // per cell: its place in occupied_ plus one, 0 when it is not occupied
  BoundedVector<Occupied> occupied_;
  Point2* sums_;  // per occupied cell; none unless keeps_sums_
  BoundedVector<std::uint32_t>
      grouped_;  // cells in the order they were grouped; the queue of the search as well
  std::uint64_t cells_dropped_ = 0;
};

}  // namespace slamsensor::core
