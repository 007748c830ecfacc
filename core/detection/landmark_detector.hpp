#pragma once

#include "core/config.hpp"
#include "core/decision/scan_view.hpp"
#include "core/detection/cell_hull.hpp"
#include "core/detection/scanline.hpp"
#include "core/detection/spiderweb.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"
#include "core/reading.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Finds the landmarks of a scan (DESIGN 2.2). A scanline is folded into the spiderweb grid when it ends;
/// only the grouping waits for the end of the scan. No allocation after construction; one thread.
class LandmarkDetector {
 public:
  /// Takes room for `capacities.occupied_cells` cells of a scan; see PolarGrid for what `config` must keep.
  LandmarkDetector(Arena& arena, const DetectionConfig& config,
                   const Capacities& capacities = Capacities{}) noexcept;

  /// Folds in one scanline: readings that share a tilt, in the order of the sweep (either direction). Which
  /// readings count, and how, is said at ScanlineGrid.
  void add_scanline(std::span<const Reading> scanline) noexcept;

  /// The landmarks of all scanlines since the last call, heaviest first, at most m_k; starts the next scan.
  /// The weight is the mean number of scanlines that see a cell of the landmark; equal weights are ordered as
  /// Spiderweb says. Valid until the next call.
  [[nodiscard]] std::span<const ScanLandmark> finish() noexcept;

  /// What the scan of the last finish() saw beside its landmarks: per column of the spiderweb the range up to
  /// which at least three scanlines (or all, if fewer looked) saw that nothing stands. A trunk stops all
  /// scanlines at its range, a bush or the ground only the low ones. Valid until the next add_scanline().
  [[nodiscard]] ScanView view() const noexcept;

  /// Sightings that found the list of occupied cells full, since construction.
  [[nodiscard]] std::uint64_t cells_dropped() const noexcept { return web_.cells_dropped(); }
  /// Readings that were NaN, infinite or otherwise impossible, since construction.
  [[nodiscard]] std::uint64_t readings_refused() const noexcept { return scanline_.readings_refused(); }

 private:
  static constexpr std::size_t kFarthest = 3;

  /// The farthest that scanlines saw in a column, in cells, the farthest first; kEmptyColumn where none
  /// looked.
  struct Farthest {
    std::array<std::int32_t, kFarthest> cells{kEmptyColumn, kEmptyColumn, kEmptyColumn};
  };

  [[nodiscard]] Point2 point_L(const CellGroup& group) noexcept;
  [[nodiscard]] double diameter_m(const CellGroup& group, double range_m) const noexcept;
  void look_far() noexcept;

  LandmarkPoint point_;
  double range_max_m_;
  ScanlineGrid scanline_;
  Spiderweb web_;
  CellHull hull_;
  BoundedVector<CellGroup> heaviest_;
  ScanLandmark* landmarks_;           // per element of heaviest_
  BoundedVector<Farthest> farthest_;  // per column
  BoundedVector<float> free_m_;       // per column
  std::uint64_t readings_ = 0;        // of the scan
  std::uint64_t looks_ = 0;           // columns of its scanlines that have a reading
};

}  // namespace slamsensor::core
