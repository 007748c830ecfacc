#include "core/detection/spiderweb.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::core {
namespace {

/// A strict order in which no two groups are equal, so that the choice does not depend on how they were
/// found.
bool ranks_before(const CellGroup& a, const CellGroup& b) noexcept {
  const double weight_a = a.weight();
  const double weight_b = b.weight();
  return weight_a != weight_b ? weight_a > weight_b : a.nearest_cell < b.nearest_cell;
}

/// Inserts `group` into the ranked list, whose last falls out when it is full.
void keep_heaviest(const CellGroup& group, BoundedVector<CellGroup>& heaviest) noexcept {
  if (!heaviest.try_push_back(group)) {
    if (heaviest.empty() || !ranks_before(group, heaviest.back())) {
      return;
    }
    heaviest.back() = group;
  }
  for (std::size_t i = heaviest.size() - 1; i > 0 && ranks_before(heaviest[i], heaviest[i - 1]); --i) {
    std::swap(heaviest[i], heaviest[i - 1]);
  }
}

}  // namespace

Spiderweb::Spiderweb(Arena& arena, const DetectionConfig& config, std::uint32_t cells_max) noexcept
    : grid_(config),
      keeps_sums_(config.point == LandmarkPoint::ReadingMean),
      slots_(arena.take<std::uint32_t>("spiderweb grid", grid_.cells())),
      occupied_(arena, "spiderweb occupied cells", std::min(cells_max, grid_.cells())),
      sums_(arena.take<Point2>("spiderweb reading sums", keeps_sums_ ? occupied_.capacity() : 0)),
      grouped_(arena, "spiderweb grouped cells", occupied_.capacity()) {
}

void Spiderweb::add(const Sighting& sighting) noexcept {
  SLAMSENSOR_ASSERT(sighting.row < grid_.rows() && sighting.column < grid_.columns());
  const std::uint32_t cell = sighting.row * grid_.columns() + sighting.column;
  if (slots_[cell] == 0) {
    if (!occupied_.try_push_back({cell, 0})) {
      ++cells_dropped_;
      return;
    }
    slots_[cell] = static_cast<std::uint32_t>(occupied_.size());
    if (keeps_sums_) {
      sums_[occupied_.size() - 1] = Point2::Zero();
    }
  }
  const std::uint32_t slot = slots_[cell] - 1;
  ++occupied_[slot].count;
  if (keeps_sums_) {
    sums_[slot] +=
        sighting.horizontal_m * Point2(std::cos(sighting.bearing_rad), std::sin(sighting.bearing_rad));
  }
}

void Spiderweb::take_heaviest(BoundedVector<CellGroup>& heaviest) noexcept {
  heaviest.clear();
  grouped_.clear();
  for (const Occupied& occupied : occupied_) {
    if (slots_[occupied.cell] != 0) {
      keep_heaviest(take_group(occupied.cell), heaviest);
    }
  }
  // Every occupied cell has been taken by its group, so the grid is all zero again.
  occupied_.clear();
}

CellGroup Spiderweb::take_group(std::uint32_t first_cell) noexcept {
  CellGroup group;
  group.begin = static_cast<std::uint32_t>(grouped_.size());
  group.nearest_cell = first_cell;
  take_cell(first_cell, group);
  for (std::size_t i = group.begin; i < grouped_.size(); ++i) {
    take_neighbours(grouped_[i], group);
  }
  return group;
}

void Spiderweb::take_neighbours(std::uint32_t cell, CellGroup& group) noexcept {
  const std::uint32_t row = cell / grid_.columns();
  const std::uint32_t column = cell % grid_.columns();
  const std::uint32_t row_end = std::min(row + 2, grid_.rows());
  for (std::uint32_t r = row == 0 ? 0 : row - 1; r < row_end; ++r) {
    for (const std::uint32_t c : {grid_.previous(column), column, grid_.next(column)}) {
      take_cell(r * grid_.columns() + c, group);
    }
  }
}

/// Moves the cell from the grid into the group; nothing when it is not occupied or already taken.
void Spiderweb::take_cell(std::uint32_t cell, CellGroup& group) noexcept {
  if (slots_[cell] == 0) {
    return;
  }
  const std::uint32_t slot = std::exchange(slots_[cell], 0) - 1;
  SLAMSENSOR_ASSERT(grouped_.try_push_back(cell));  // never full: an occupied cell is taken once
  ++group.size;
  const auto count = static_cast<double>(occupied_[slot].count);
  group.count += occupied_[slot].count;
  const double beside =
      grid_.columns_between(grouped_[group.begin] % grid_.columns(), cell % grid_.columns());
  group.sum_columns += count * beside;
  group.sum_columns2 += count * beside * beside;
  group.nearest_cell = std::min(group.nearest_cell, cell);
  if (keeps_sums_) {
    group.sum_x_m += sums_[slot].x();
    group.sum_y_m += sums_[slot].y();
  }
}

std::span<const std::uint32_t> Spiderweb::cells(const CellGroup& group) const noexcept {
  return grouped_.span().subspan(group.begin, group.size);
}

std::uint32_t Spiderweb::count(std::uint32_t row, std::uint32_t column) const noexcept {
  SLAMSENSOR_ASSERT(row < grid_.rows() && column < grid_.columns());
  const std::uint32_t slot = slots_[row * grid_.columns() + column];
  return slot == 0 ? 0 : occupied_[slot - 1].count;
}

}  // namespace slamsensor::core
