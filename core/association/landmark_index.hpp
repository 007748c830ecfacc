#pragma once

#include "core/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace slamsensor::core {

/// Number of a map among those that are kept at once. Landmarks of different maps have nothing to do with
/// each other until the maps are tied.
using MapSlot = std::uint16_t;

/// What the fast search looks up: the landmarks of all maps by place, and by the triangles that they form
/// with their neighbours. It follows the maps: each change costs as much as the neighbourhood of the landmark
/// that changed, never as much as the map. One thread; no allocation after construction.
///
/// Triangles. A landmark is linked to its `index_neighbours` nearest (at least kSideMin tolerances away, at
/// most kLinkRange_m). It is the apex of each triangle with two of them in which its own corner lies opposite
/// the longest side, so that a triangle is listed once, however it is turned. Triangles lie in buckets by
/// their longest and middle side; an entry carries all three sides to 1/64 m, so that nearly all are refused
/// without a look at a landmark. Memory: a landmark takes 16 bytes of place, 44 of links and about 66 of
/// triangles.
class LandmarkIndex {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  static constexpr std::uint32_t kNeighboursMax = 8;  ///< two of them are three bits each in an entry
  static constexpr double kLinkRange_m = 40.0;        ///< longer sides are not linked
  static constexpr double kSideMin = 2.0;           ///< in tolerances: shorter sides say nothing of a heading
  static constexpr double kSideMinLargest_m = 2.0;  ///< however large the tolerance is

  /// A triangle as it is asked for. Sides in m, longest >= middle >= shortest up to the window.
  struct Sides {
    float longest_m = 0.0F;   ///< opposite the apex
    float middle_m = 0.0F;    ///< from the apex to the second corner
    float shortest_m = 0.0F;  ///< from the apex to the third corner
  };
  enum class Turn : std::uint8_t { Clockwise, CounterClockwise, Either };

  LandmarkIndex(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept;

  /// Lists the landmark in `slot` (below capacities.map_landmarks, not listed). `p` is in the frame of `map`,
  /// m.
  void insert(std::uint32_t slot, MapSlot map, const Point2& p) noexcept;
  /// The landmark stands at `p` now. Look-ups by place follow at once; its triangles when it has moved by
  /// more than a quarter of the tolerance since they were listed.
  void move(std::uint32_t slot, const Point2& p) noexcept;
  void erase(std::uint32_t slot) noexcept;
  void clear() noexcept;

  /// The landmark of `map` nearest to `p` within `radius_m`, or kNone. `distance2_m2` receives its distance
  /// squared.
  [[nodiscard]] std::uint32_t nearest_within(MapSlot map, const Point2& p, double radius_m,
                                             double& distance2_m2) const noexcept;

  /// Calls `visit(slot, distance2_m2)` for each landmark of `map` within `radius_m` of `p`, once.
  template <typename Visit>
  void visit_within(MapSlot map, const Point2& p, double radius_m, Visit&& visit) const noexcept;

  /// Calls `visit(apex, second, third)` for each listed triangle whose sides agree with `sides` within
  /// `window_m` and that turns as asked (apex, second, third). Returns the number of entries that were looked
  /// at.
  template <typename Visit>
  std::uint64_t visit_triangles(const Sides& sides, float window_m, Turn turn, Visit&& visit) const noexcept;

  /// How many entries `visit_triangles` would look at, to order the work.
  [[nodiscard]] std::uint64_t triangle_entries(const Sides& sides, float window_m) const noexcept;

  [[nodiscard]] MapSlot map_of(std::uint32_t slot) const noexcept { return places_[slot].map; }
  [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
  /// Shortest side that is linked, m.
  [[nodiscard]] double side_min_m() const noexcept { return side_min_m_; }
  /// Triangles that found no room since construction.
  [[nodiscard]] std::uint64_t triangles_dropped() const noexcept { return triangles_dropped_; }

 private:
  static constexpr double kCellSide_m = 4.0;
  static constexpr float kBucketsPerM = 2.0F;
  static constexpr std::uint32_t kBucketRows = 161;  // sides up to 80 m: twice the link range
  static constexpr float kFinePerM = 64.0F;
  static constexpr std::uint32_t kChunkEntries = 15;

  struct Place {
    float x_m;
    float y_m;
    std::uint32_t next;  // in the chain of its cell's hash
    MapSlot map;
    std::uint16_t is_listed;
  };
  struct Links {
    float x_m;  // where the landmark stood when its triangles were listed
    float y_m;
    std::uint32_t count;
    std::array<std::uint32_t, kNeighboursMax> neighbours;
  };
  /// sides: 13 bits of the longest, 13 of the middle, 12 of the shortest (within 64 m), 1/64 m; 6 bits of the
  /// pair; 1 of the turn. Together with the apex 77 bits: the two larger ones are stored relative to their
  /// bucket.
  struct Entry {
    std::uint32_t apex;
    std::uint32_t packed;
  };
  struct Chunk {
    std::uint32_t next;
    std::uint32_t count;
    std::array<Entry, kChunkEntries> entries;
  };
  struct Found {
    std::uint32_t slot;
    float distance2_m2;
  };
  /// A triangle between its landmarks and its entry.
  struct Shape {
    std::uint32_t bucket;
    std::uint32_t packed;
  };

  static constexpr std::uint32_t kFinePerBucket = static_cast<std::uint32_t>(kFinePerM / kBucketsPerM);

  [[nodiscard]] std::size_t cell_of(MapSlot map, std::int64_t column, std::int64_t row) const noexcept {
    std::uint64_t h = static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15U;
    h ^= static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4FU;
    h ^= static_cast<std::uint64_t>(map) * 0x165667B19E3779F9U;
    h ^= h >> 29U;
    return static_cast<std::size_t>((h * 0xBF58476D1CE4E5B9U) >> cell_shift_);
  }
  [[nodiscard]] static std::int64_t cell_floor(double v_m) noexcept {
    return static_cast<std::int64_t>(std::floor(v_m * (1.0 / kCellSide_m)));
  }
  [[nodiscard]] static std::int64_t cell_floor(float v_m) noexcept {
    return cell_floor(static_cast<double>(v_m));
  }
  [[nodiscard]] static std::uint32_t bucket_at(std::uint32_t longest, std::uint32_t middle) noexcept {
    return longest * (longest + 1) / 2 + middle;
  }

  void put_in_cell(std::uint32_t slot) noexcept;
  void take_from_cell(std::uint32_t slot) noexcept;
  void link(std::uint32_t slot) noexcept;
  void find_neighbours(std::uint32_t slot) noexcept;
  void offer_neighbour(std::uint32_t to, std::uint32_t slot) noexcept;
  void unlink_from_others(std::uint32_t slot) noexcept;
  void list_triangles(std::uint32_t slot) noexcept;
  void unlist_triangles(std::uint32_t slot) noexcept;
  [[nodiscard]] bool shape_of(std::uint32_t apex, std::uint32_t i, std::uint32_t j,
                              Shape& shape) const noexcept;
  void add_entry(const Shape& shape, std::uint32_t apex) noexcept;
  void remove_entry(const Shape& shape, std::uint32_t apex) noexcept;
  [[nodiscard]] float distance2(std::uint32_t a, std::uint32_t b) const noexcept;

  std::uint32_t neighbours_max_;
  double side_min_m_;
  double relink_move_m_;
  std::uint32_t cell_shift_;
  BoundedVector<std::uint32_t> cells_;  // heads of chains
  BoundedVector<Place> places_;
  BoundedVector<Links> links_;
  BoundedVector<std::uint32_t> buckets_;  // heads of chunk lists
  BoundedVector<Chunk> chunks_;
  std::uint32_t free_chunks_ = kNone;
  std::uint32_t chunks_used_ = 0;
  std::uint32_t size_ = 0;
  std::uint64_t triangles_dropped_ = 0;
};

template <typename Visit>
void LandmarkIndex::visit_within(MapSlot map, const Point2& p, double radius_m,
                                 Visit&& visit) const noexcept {
  const std::int64_t column_end = cell_floor(p.x() + radius_m);
  const std::int64_t row_end = cell_floor(p.y() + radius_m);
  const double radius2 = radius_m * radius_m;
  const auto x_m = static_cast<float>(p.x());
  const auto y_m = static_cast<float>(p.y());
  const Place* const places = places_.data();
  const std::uint32_t* const cells = cells_.data();
  for (std::int64_t row = cell_floor(p.y() - radius_m); row <= row_end; ++row) {
    for (std::int64_t column = cell_floor(p.x() - radius_m); column <= column_end; ++column) {
      for (std::uint32_t slot = cells[cell_of(map, column, row)]; slot != kNone; slot = places[slot].next) {
        const Place& place = places[slot];
        const float dx = place.x_m - x_m;
        const float dy = place.y_m - y_m;
        const auto d2 = static_cast<double>(dx * dx + dy * dy);
        if (d2 <= radius2 && place.map == map && cell_floor(place.x_m) == column &&
            cell_floor(place.y_m) == row) {
          visit(slot, d2);  // a chain may hold several cells: each visits its own
        }
      }
    }
  }
}

template <typename Visit>
std::uint64_t LandmarkIndex::visit_triangles(const Sides& sides, float window_m, Turn turn,
                                             Visit&& visit) const noexcept {
  std::uint64_t looked_at = 0;
  const auto low = [&](float side_m) { return std::max(0.0F, side_m - window_m); };
  const auto row_of = [](float side_m) {
    return std::min(static_cast<std::uint32_t>(side_m * kBucketsPerM), kBucketRows - 1);
  };
  const auto fine = [](float side_m) { return static_cast<std::int32_t>(side_m * kFinePerM); };
  const std::int32_t longest_low = fine(low(sides.longest_m));
  const std::int32_t longest_high = fine(sides.longest_m + window_m);
  const std::int32_t middle_low = fine(low(sides.middle_m));
  const std::int32_t middle_high = fine(sides.middle_m + window_m);
  const std::int32_t shortest_low = fine(low(sides.shortest_m));
  const std::int32_t shortest_high = fine(sides.shortest_m + window_m);
  const std::uint32_t row_last = row_of(sides.longest_m + window_m);
  for (std::uint32_t row = row_of(low(sides.longest_m)); row <= row_last; ++row) {
    const std::uint32_t column_last = std::min(row, row_of(sides.middle_m + window_m));
    for (std::uint32_t column = row_of(low(sides.middle_m)); column <= column_last; ++column) {
      for (std::uint32_t c = buckets_[bucket_at(row, column)]; c != kNone; c = chunks_[c].next) {
        const Chunk& chunk = chunks_[c];
        looked_at += chunk.count;
        for (std::uint32_t i = 0; i < chunk.count; ++i) {
          const std::uint32_t packed = chunk.entries[i].packed;
          const auto shortest = static_cast<std::int32_t>(packed >> 20U);
          const auto longest = static_cast<std::int32_t>(row * kFinePerBucket + ((packed >> 15U) & 31U));
          const auto middle = static_cast<std::int32_t>(column * kFinePerBucket + ((packed >> 10U) & 31U));
          if (shortest < shortest_low || shortest > shortest_high || longest < longest_low ||
              longest > longest_high || middle < middle_low || middle > middle_high) {
            continue;
          }
          const Turn has = (packed & 1U) != 0 ? Turn::CounterClockwise : Turn::Clockwise;
          if (turn != Turn::Either && turn != has) {
            continue;
          }
          const std::uint32_t apex = chunk.entries[i].apex;
          const Links& links = links_[apex];
          visit(apex, links.neighbours[(packed >> 4U) & 7U], links.neighbours[(packed >> 1U) & 7U]);
        }
      }
    }
  }
  return looked_at;
}

}  // namespace slamsensor::core
