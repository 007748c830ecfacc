#pragma once

#include "core/association/landmark_index.hpp"
#include "core/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <array>
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
      areas_of_[map] += cell->looks == 0 ? 1 : 0;
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

  /// What was looked at in `map` is new ground again. Its cells are told by the map's generation and make
  /// room when they are met, so that only one call in kGenerations looks at the table.
  void forget(MapSlot map) noexcept {
    if (++generations_[map] == kGenerations) {
      generations_[map] = 0;
      for (Cell& cell : cells_) {
        cell.looks = slot_of(cell.key) == map ? 0 : cell.looks;
      }
    }
    areas_ -= areas_of_[map];
    areas_of_[map] = 0;
  }

  void clear() noexcept {
    for (Cell& cell : cells_) {
      cell = Cell{};
    }
    areas_ = 0;
    areas_of_ = {};
    generations_ = {};
  }

  [[nodiscard]] std::uint64_t cells_dropped() const noexcept { return dropped_; }

 private:
  // 20 bits of each coordinate, 11 of the map's generation, 4 of the map, 1 that says that it is taken.
  using Key = std::uint64_t;
  static constexpr std::uint32_t kMapBits = 4;
  static constexpr std::uint32_t kMaps = 1U << kMapBits;
  static constexpr std::uint32_t kGenerations = 1U << 11U;
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
  [[nodiscard]] Key key_of(MapSlot map, const Point2& p) const noexcept {
    const auto cell = [](double v) {
      return static_cast<Key>(static_cast<std::int64_t>(std::floor(v / kCell_m))) & 0xFFFFFU;
    };
    const Key map_key = (Key{generations_[map]} << kMapBits) | map;
    return (((cell(p.x()) << 20U) | cell(p.y())) << 16U) | (map_key << 1U) | 1U;
  }
  [[nodiscard]] static MapSlot slot_of(Key key) noexcept {
    return static_cast<MapSlot>((key >> 1U) & (kMaps - 1U));
  }
  /// Whether the cell says nothing: not looked at, or of a map that was forgotten.
  [[nodiscard]] bool is_free(const Cell& cell) const noexcept {
    return cell.looks == 0 ||
           ((cell.key >> (1U + kMapBits)) & (kGenerations - 1U)) != generations_[slot_of(cell.key)];
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
      if (free == nullptr && is_free(cell)) {
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
  std::array<std::uint16_t, kMaps> generations_{};
  std::array<std::uint64_t, kMaps> areas_of_{};  // cells looked at, by map
  std::uint64_t areas_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace slamsensor::core
