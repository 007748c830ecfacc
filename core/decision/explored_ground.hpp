#pragma once

#include "core/association/landmark_index.hpp"
#include "core/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cmath>
#include <cstdint>

namespace slamsensor::core {

/// How well the ground of each map has been looked at: cells of 4 m with the chance that a landmark standing
/// there would have been seen by now. What has no counterpart on explored ground speaks against a pose; on
/// new ground it says nothing. A hash of 8 bytes a cell; a full table counts what it leaves out, which then
/// counts as new ground. One thread; no allocation after construction.
class ExploredGround {
 public:
  static constexpr double kCell_m = 4.0;

  ExploredGround(Arena& arena, const Capacities& capacities) noexcept
      : cells_(arena, "decision: explored ground", table_size(capacities)) {
    SLAMSENSOR_ASSERT(cells_.try_resize(cells_.capacity()));
  }

  /// A look at the cell about `p_W`, of a kind that shows a landmark with chance `detection`.
  void look(MapSlot map, const Point2& p_W, double detection) noexcept {
    if (Cell* const cell = find_or_add(map, p_W)) {
      const double nats = -std::log1p(-std::min(detection, 0.95));
      areas_ += cell->looks == 0 ? 1 : 0;
      cell->looks = static_cast<std::uint8_t>(std::min(255.0, cell->looks + std::ceil(nats * kPerNat)));
    }
  }

  /// The chance that a landmark at `p_W` would be in the map, in [0, 1).
  [[nodiscard]] double explored(MapSlot map, const Point2& p_W) const noexcept {
    const Key key = key_of(map, p_W);
    for (std::size_t i = first(key), tries = 0; tries < kProbes; ++tries, i = next(i)) {
      const Cell& cell = cells_[i];
      if (cell.key == key && cell.looks > 0) {
        return 1.0 - std::exp(-cell.looks / kPerNat);
      }
      if (cell.key == 0) {
        break;
      }
    }
    return 0.0;
  }

  /// Ground that was looked at in all maps, m^2.
  [[nodiscard]] double area_m2() const noexcept { return static_cast<double>(areas_) * kCell_m * kCell_m; }

  /// What was looked at in `map` is new ground again.
  void forget(MapSlot map) noexcept {
    for (Cell& cell : cells_) {
      if (cell.looks > 0 && map_of(cell.key) == map) {
        cell.looks = 0;
        --areas_;
      }
    }
  }

  void clear() noexcept {
    for (Cell& cell : cells_) {
      cell = Cell{};
    }
    areas_ = 0;
  }

  [[nodiscard]] std::uint64_t cells_dropped() const noexcept { return dropped_; }

 private:
  using Key = std::uint64_t;  // 20 bits of each coordinate, 15 of the map, 1 that says that it is taken
  struct Cell {
    Key key : 56 = 0;
    Key looks : 8 = 0;
  };
  static constexpr double kPerNat = 16.0;
  static constexpr std::size_t kProbes = 16;

  [[nodiscard]] static std::size_t table_size(const Capacities& capacities) noexcept {
    std::size_t size = 1024;
    while (size < std::size_t{4} * capacities.map_landmarks) {
      size *= 2;
    }
    return size;
  }
  [[nodiscard]] static Key key_of(MapSlot map, const Point2& p) noexcept {
    const auto cell = [](double v) {
      return static_cast<Key>(static_cast<std::int64_t>(std::floor(v / kCell_m))) & 0xFFFFFU;
    };
    return (((cell(p.x()) << 20U) | cell(p.y())) << 16U) | (static_cast<Key>(map & 0x7FFFU) << 1U) | 1U;
  }
  [[nodiscard]] static MapSlot map_of(Key key) noexcept {
    return static_cast<MapSlot>((key >> 1U) & 0x7FFFU);
  }
  [[nodiscard]] std::size_t first(Key key) const noexcept {
    Key h = key * 0x9E3779B97F4A7C15U;
    h ^= h >> 32U;
    return static_cast<std::size_t>(h) & (cells_.size() - 1);
  }
  [[nodiscard]] std::size_t next(std::size_t i) const noexcept { return (i + 1) & (cells_.size() - 1); }

  [[nodiscard]] Cell* find_or_add(MapSlot map, const Point2& p) noexcept {
    const Key key = key_of(map, p);
    Cell* free = nullptr;
    for (std::size_t i = first(key), tries = 0; tries < kProbes; ++tries, i = next(i)) {
      Cell& cell = cells_[i];
      if (cell.key == key) {
        return &cell;
      }
      if (cell.looks == 0 && free == nullptr) {
        free = &cell;
      }
      if (cell.key == 0) {
        break;
      }
    }
    if (free == nullptr) {
      ++dropped_;
      return nullptr;
    }
    free->key = key & ((Key{1} << 56U) - 1);
    free->looks = 0;
    return free;
  }

  BoundedVector<Cell> cells_;
  std::uint64_t areas_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace slamsensor::core
