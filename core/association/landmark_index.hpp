#pragma once

#include "core/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace slamsensor::core {

/// Number of a map among those that are kept at once. Landmarks of different maps have nothing to do with
/// each other until the maps are tied.
using MapSlot = std::uint16_t;

/// What the fast search looks up: the landmarks of all maps by place, and by the triangles that they form
/// with their neighbours. It follows the maps: each change costs as much as the neighbourhood of the landmark
/// that changed, never as much as the map. One thread; no allocation after construction.
///
/// Stars. A landmark is linked to its `index_neighbours` nearest (at least kSideMin tolerances away, at most
/// kLinkRange_m). Its star is the list of where they stand relative to it, 4 bytes each: all that a search
/// needs to turn a triangle into a pose and to refute that pose by the neighbours that are left, without a
/// look at any other landmark.
///
/// Triangles. A landmark is the apex of each triangle with two of its star in which its own corner lies
/// opposite the longest side, so that a triangle is listed once, however it is turned. An entry of 4 bytes
/// names the apex and the pair, and holds the low bits of the three sides in eighths of the tolerance; their
/// high bits and the turn choose the entry's bucket. Buckets hold about ten entries, whatever the size of the
/// map, because their number grows with it; a tag of the bits that are left tells the triangles apart that
/// share one.
///
/// Ground. A word of 64 bits for each cell says where in it a landmark may be near, so that most places where
/// there is none are refused by one look. Cells are numbered along their rows, and the number, modulo the
/// words that there are, is the word's place. So the neighbours of a cell share words with the neighbours of
/// every cell that shares its own, and a word can be drawn again from what is listed about it.
///
/// Memory of a landmark: 16 bytes of place, 6 to 12 of cells and ground, 24 of star and about 70 of
/// triangles with 6 neighbours; with 3 neighbours 12 of star and 15 of triangles.
class LandmarkIndex {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  static constexpr std::uint32_t kNeighboursMin = 3;
  static constexpr std::uint32_t kNeighboursMax = 8;  ///< their 28 pairs are five bits in an entry
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

  /// Where a neighbour stands relative to its landmark, in 1/kOffsetsPerM m. Both zero: no neighbour.
  struct Offset {
    std::int16_t x = 0;
    std::int16_t y = 0;

    [[nodiscard]] bool is_some() const noexcept { return x != 0 || y != 0; }
    [[nodiscard]] float x_m() const noexcept { return static_cast<float>(x) * (1.0F / kOffsetsPerM); }
    [[nodiscard]] float y_m() const noexcept { return static_cast<float>(y) * (1.0F / kOffsetsPerM); }
  };
  static constexpr float kOffsetsPerM = 512.0F;

  /// Two neighbours of a star, by their places in it.
  struct Pair {
    std::uint8_t first = 0;
    std::uint8_t second = 0;
  };

  LandmarkIndex(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept;

  /// Lists the landmark in `slot` (below capacities.map_landmarks, not listed). `p` is in the frame of `map`,
  /// m.
  void insert(std::uint32_t slot, MapSlot map, const Point2& p) noexcept;
  /// The landmark stands at `p` now. Look-ups by place follow at once; its triangles when it has moved by
  /// more than a quarter of the tolerance since they were listed.
  void move(std::uint32_t slot, const Point2& p) noexcept;
  void erase(std::uint32_t slot) noexcept;
  void clear() noexcept;

  /// False when no landmark of any map stands within ground_reach_m() of `p`; true may be wrong.
  [[nodiscard]] bool may_be_near(MapSlot map, const Point2& p) const noexcept {
    const std::int32_t x = floor_of(p.x() * kGroundPerM);
    const std::int32_t y = floor_of(p.y() * kGroundPerM);
    const std::uint64_t word = ground_.data()[cell_of(map, x >> kGroundShift, y >> kGroundShift)];
    return ((word >> ground_bit(x, y)) & 1U) != 0;
  }
  [[nodiscard]] double ground_reach_m() const noexcept { return ground_reach_m_; }

  /// The landmark of `map` nearest to `p` within `radius_m`, or kNone. `distance2_m2` receives its distance
  /// squared.
  [[nodiscard]] std::uint32_t nearest_within(MapSlot map, const Point2& p, double radius_m,
                                             double& distance2_m2) const noexcept;

  /// Calls `visit(slot, distance2_m2)` for each landmark of `map` within `radius_m` of `p`, once.
  template <typename Visit>
  void visit_within(MapSlot map, const Point2& p, double radius_m, Visit&& visit) const noexcept;

  /// Calls `visit(apex, pair)` for each listed triangle whose sides agree with `sides` within `window_m` (and
  /// an eighth of the tolerance) and that turns as asked (apex, the farther of the pair, the nearer), and
  /// `more(entries)` after each run of entries, with their number. Ends when `more` returns false. Some of
  /// what is visited may have other sides: the caller checks the star. Fetches the stars ahead of the visits.
  template <typename Visit, typename More>
  void visit_triangles(const Sides& sides, float window_m, Turn turn, Visit&& visit,
                       More&& more) const noexcept;

  /// How many entries one bucket of the triangles with such sides holds, to order the work.
  [[nodiscard]] std::uint32_t bucket_entries(const Sides& sides, bool is_counter_clockwise) const noexcept;

  /// The neighbours of a landmark as they were linked.
  [[nodiscard]] std::span<const Offset> star(std::uint32_t slot) const noexcept {
    return {stars_.data() + std::size_t{slot} * neighbours_, neighbours_};
  }
  /// Where a landmark stands, to about 1e-4 m.
  [[nodiscard]] Point2 place(std::uint32_t slot) const noexcept {
    return {static_cast<double>(places_[slot].x_m), static_cast<double>(places_[slot].y_m)};
  }
  [[nodiscard]] MapSlot map_of(std::uint32_t slot) const noexcept { return places_[slot].map; }
  [[nodiscard]] std::uint32_t size() const noexcept { return size_; }
  /// Shortest side that is linked, m.
  [[nodiscard]] double side_min_m() const noexcept { return side_min_m_; }
  /// Triangles that are listed.
  [[nodiscard]] std::uint64_t triangles() const noexcept { return triangles_; }
  /// Triangles that found no room since construction.
  [[nodiscard]] std::uint64_t triangles_dropped() const noexcept { return triangles_dropped_; }

 private:
  static constexpr double kCellSide_m = 5.0;
  static constexpr int kGroundShift = 3;  // a cell is 8 by 8 places of ground
  static constexpr std::int32_t kGroundSide = 1 << kGroundShift;
  static constexpr double kGroundPerM = kGroundSide / kCellSide_m;
  static constexpr std::uint32_t kChunkEntries = 7;

  struct Place {
    float x_m;
    float y_m;
    std::uint32_t next;  // in the chain of its cell's hash
    std::uint8_t map;
    std::uint8_t is_listed;
    std::uint8_t linked_x;  // where it stood when its star was made, in steps, modulo 256
    std::uint8_t linked_y;
  };
  using Entry = std::uint32_t;  // from the top: apex, pair, tag, low bits of longest, middle and shortest
  struct Chunk {
    std::array<Entry, kChunkEntries + 1> words;  // the last one is the number of the next chunk

    [[nodiscard]] std::uint32_t next() const noexcept { return words[kChunkEntries]; }
    void set_next(std::uint32_t chunk) noexcept { words[kChunkEntries] = chunk; }
  };
  struct Bucket {
    std::uint32_t head = kNone;  // the chunk that is not full
    std::uint32_t count = 0;     // entries in all its chunks
  };
  struct Found {
    std::uint32_t slot;
    float distance2_m2;
  };
  /// A triangle between its landmarks and its entry.
  struct Shape {
    std::uint32_t bucket;
    Entry entry;
  };
  /// The sides of a triangle in eighths of the tolerance.
  struct Units {
    std::uint32_t longest;
    std::uint32_t middle;
    std::uint32_t shortest;
  };
  /// A side's range, of units.
  struct Range {
    std::uint32_t low;
    std::uint32_t high;
  };

  struct Within {
    std::int32_t low;
    std::int32_t high;
  };
  /// A bucket, and what its entries are held against.
  struct Asked {
    std::uint32_t head;
    std::uint32_t count;
    std::int32_t tag;
    Within longest;
    Within middle;
    Within shortest;
  };
  static constexpr std::uint32_t kBatch = 16;
  static constexpr std::uint32_t kKept = 64;
  /// Buckets that are looked through together, and the entries of them that agree.
  struct Batch {
    std::uint32_t buckets = 0;
    std::array<Asked, kBatch> asked;  // NOLINT: what is read is written before
    std::array<Entry, kKept> kept;    // NOLINT: the same
  };
  /// Where an entry has its fields.
  struct Layout {
    int tag_shift;
    int longest_shift;
    int middle_shift;
    std::int32_t tag_mask;
    std::int32_t low_mask;
  };
  static constexpr std::size_t kLanes = 4;
  using Lanes [[gnu::vector_size(kLanes * sizeof(std::int32_t))]] = std::int32_t;
  using Refused = std::array<std::int32_t, kChunkEntries + 1>;

  [[nodiscard]] static std::int32_t floor_of(double v) noexcept {
    const auto whole = static_cast<std::int32_t>(v);
    return whole - (v < static_cast<double>(whole) ? 1 : 0);
  }
  [[nodiscard]] static std::int32_t cell_floor(double v_m) noexcept {
    return floor_of(v_m * (1.0 / kCellSide_m));
  }
  [[nodiscard]] static std::int32_t cell_floor(float v_m) noexcept {
    return cell_floor(static_cast<double>(v_m));
  }
  /// Rows begin so far from each other that maps of any shape use all places evenly.
  [[nodiscard]] std::size_t cell_of(MapSlot map, std::int32_t column, std::int32_t row) const noexcept {
    return (static_cast<std::uint32_t>(column) + static_cast<std::uint32_t>(row) * cell_stride_ +
            std::uint32_t{map} * kMapStride) &
           cell_mask_;
  }
  static constexpr std::uint32_t kMapStride = 0x9E3779B1U;
  [[nodiscard]] static std::uint32_t ground_bit(std::int32_t x, std::int32_t y) noexcept {
    constexpr std::int32_t kMask = kGroundSide - 1;
    return static_cast<std::uint32_t>(((y & kMask) << kGroundShift) | (x & kMask));
  }
  /// The bucket of the first of a row of cells, which differ in the shortest side.
  [[nodiscard]] std::uint32_t row_of(std::uint32_t longest_cell, std::uint32_t middle_cell,
                                     std::uint32_t turn) const noexcept {
    std::uint32_t h = longest_cell * 0x9E3779B1U + middle_cell * 0x85EBCA77U + turn * 0xC2B2AE3DU;
    h = (h ^ (h >> 15U)) * 0x2C1B3C6DU;
    return h ^ (h >> 13U);
  }
  [[nodiscard]] std::uint32_t bucket_of(std::uint32_t row, std::uint32_t shortest_cell) const noexcept {
    return (row + shortest_cell) & bucket_mask_;
  }

  [[nodiscard]] std::int32_t tag_of(std::uint32_t row) const noexcept {
    return static_cast<std::int32_t>((row >> 20U) & tag_mask_);
  }
  /// The part of a range that lies in a cell, from the cell's beginning on.
  [[nodiscard]] Within within(const Range& range, std::uint32_t cell) const noexcept {
    const auto begin = static_cast<std::int32_t>(cell << low_bits_);
    return {static_cast<std::int32_t>(range.low) - begin, static_cast<std::int32_t>(range.high) - begin};
  }
  [[nodiscard]] Layout layout() const noexcept {
    return {static_cast<int>(3U * low_bits_), static_cast<int>(2U * low_bits_), static_cast<int>(low_bits_),
            static_cast<std::int32_t>(tag_mask_), static_cast<std::int32_t>((1U << low_bits_) - 1U)};
  }
  template <typename Visit, typename More>
  [[nodiscard]] bool visit_batch(Batch& batch, Visit&& visit, More&& more) const noexcept;
  [[nodiscard]] static Refused refuse(const Chunk& chunk, const Asked& asked, const Layout& layout) noexcept;
  [[nodiscard]] Point2 linked_place(const Place& place) const noexcept;
  [[nodiscard]] std::uint64_t ground_of(const Point2& p, std::int32_t column,
                                        std::int32_t row) const noexcept;
  [[nodiscard]] std::uint64_t ground_about(MapSlot map, std::int32_t column, std::int32_t row) const noexcept;
  template <typename Visit>
  void visit_ground_cells(const Point2& p, Visit&& visit) const noexcept;
  void draw_ground(std::uint32_t slot) noexcept;
  void redraw_ground(MapSlot map, const Point2& p) noexcept;
  void put_in_cell(std::uint32_t slot) noexcept;
  void take_from_cell(std::uint32_t slot) noexcept;
  void note_linked(Place& place) const noexcept;
  [[nodiscard]] bool has_moved(const Place& place) const noexcept;
  void make_star(std::uint32_t slot) noexcept;
  void drop_star(std::uint32_t slot) noexcept;
  void find_neighbours(std::uint32_t slot, std::array<Found, kNeighboursMax>& best,
                       std::uint32_t& count) const noexcept;
  [[nodiscard]] Offset offset_between(std::uint32_t from, std::uint32_t to) const noexcept;
  [[nodiscard]] std::uint32_t ray_to(std::uint32_t from, std::uint32_t to) const noexcept;
  void offer_to_others(std::uint32_t slot) noexcept;
  void offer(std::uint32_t to, std::uint32_t slot) noexcept;
  void refresh_others(std::uint32_t slot) noexcept;
  void unlink_from_others(std::uint32_t slot) noexcept;
  void set_ray(std::uint32_t slot, std::uint32_t ray, Offset offset) noexcept;
  [[nodiscard]] bool shape_of(std::uint32_t apex, std::uint32_t i, std::uint32_t j,
                              Shape& shape) const noexcept;
  void add_entry(const Shape& shape) noexcept;
  void remove_entry(const Shape& shape) noexcept;
  [[nodiscard]] float distance2(std::uint32_t a, std::uint32_t b) const noexcept;
  [[nodiscard]] std::span<Offset> star_at(std::uint32_t slot) noexcept {
    return {stars_.data() + std::size_t{slot} * neighbours_, neighbours_};
  }
  [[nodiscard]] Range range_of(float side_m, float window_m) const noexcept {
    return {static_cast<std::uint32_t>(std::max(0.0F, side_m - window_m) * units_per_m_),
            static_cast<std::uint32_t>((side_m + window_m) * units_per_m_)};
  }

  std::uint32_t neighbours_;
  double side_min_m_;
  double relink_move_m_;
  float units_per_m_;
  std::uint32_t pair_shift_;  // of an entry
  std::uint32_t apex_shift_;
  std::uint32_t low_bits_;  // of each side in an entry
  std::uint32_t tag_mask_;  // of an entry: what bits are left tell rows of cells apart that share a bucket
  std::uint32_t cell_mask_;
  std::uint32_t cell_stride_;  // from row to row
  std::uint32_t bucket_mask_;
  double ground_reach_m_;                // of what the ground says
  double ground_radius_m_;               // drawn about a landmark
  BoundedVector<std::uint32_t> cells_;   // heads of chains
  BoundedVector<std::uint64_t> ground_;  // by cell: where a landmark may be near
  BoundedVector<Place> places_;
  BoundedVector<Offset> stars_;
  BoundedVector<Bucket> buckets_;
  BoundedVector<Chunk> chunks_;
  std::uint32_t free_chunks_ = kNone;
  std::uint32_t chunks_used_ = 0;
  std::uint32_t size_ = 0;
  std::uint64_t triangles_ = 0;
  std::uint64_t triangles_dropped_ = 0;
};

template <typename Visit>
void LandmarkIndex::visit_within(MapSlot map, const Point2& p, double radius_m,
                                 Visit&& visit) const noexcept {
  const std::int32_t column_first = cell_floor(p.x() - radius_m);
  const std::int32_t column_end = cell_floor(p.x() + radius_m);
  const std::int32_t row_end = cell_floor(p.y() + radius_m);
  const double radius2 = radius_m * radius_m;
  const auto x_m = static_cast<float>(p.x());
  const auto y_m = static_cast<float>(p.y());
  const Place* const places = places_.data();
  const std::uint32_t* const cells = cells_.data();
  for (std::int32_t row = cell_floor(p.y() - radius_m); row <= row_end; ++row) {
    for (std::int32_t column = column_first; column <= column_end; ++column) {
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

namespace index_detail {

/// Pairs (i, j), i < j, by the number j (j - 1) / 2 + i.
inline constexpr auto kPairs = [] {
  std::array<LandmarkIndex::Pair, 32> pairs{};
  for (std::size_t j = 1; j < LandmarkIndex::kNeighboursMax; ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      pairs[j * (j - 1) / 2 + i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j)};
    }
  }
  return pairs;
}();

}  // namespace index_detail

template <typename Visit, typename More>
void LandmarkIndex::visit_triangles(const Sides& sides, float window_m, Turn turn, Visit&& visit,
                                    More&& more) const noexcept {
  const Range longest = range_of(sides.longest_m, window_m);
  const Range middle = range_of(sides.middle_m, window_m);
  const Range shortest = range_of(sides.shortest_m, window_m);
  const std::uint32_t low = low_bits_;
  const std::uint32_t turn_first = turn == Turn::CounterClockwise ? 1U : 0U;
  const std::uint32_t turn_last = turn == Turn::Clockwise ? 0U : 1U;
  Batch batch;
  for (std::uint32_t l = longest.low >> low; l <= longest.high >> low; ++l) {
    for (std::uint32_t m = middle.low >> low; m <= std::min(l, middle.high >> low); ++m) {
      for (std::uint32_t t = turn_first; t <= turn_last; ++t) {
        const std::uint32_t row = row_of(l, m, t);
        for (std::uint32_t s = shortest.low >> low; s <= std::min(m, shortest.high >> low); ++s) {
          const Bucket& bucket = buckets_.data()[bucket_of(row, s)];
          if (bucket.count == 0) {
            continue;
          }
          __builtin_prefetch(&chunks_.data()[bucket.head]);
          batch.asked[batch.buckets++] = {bucket.head,        bucket.count,      tag_of(row),
                                          within(longest, l), within(middle, m), within(shortest, s)};
          if (batch.buckets == kBatch && !visit_batch(batch, visit, more)) {
            return;
          }
        }
      }
    }
  }
  static_cast<void>(visit_batch(batch, visit, more));
}

/// Looks through the buckets of a batch, then visits what was kept of them: memory has had time to come.
/// False when the visitor wants no more.
template <typename Visit, typename More>
bool LandmarkIndex::visit_batch(Batch& batch, Visit&& visit, More&& more) const noexcept {
  const Chunk* const chunks = chunks_.data();
  const Layout layout = this->layout();
  std::uint32_t entries = 0;
  std::uint32_t kept = 0;
  const auto visit_kept = [&] {
    for (std::uint32_t i = 0; i < kept; ++i) {
      const Entry entry = batch.kept[i];
      visit(entry >> apex_shift_,
            index_detail::kPairs[(entry >> pair_shift_) & ((Entry{1} << (apex_shift_ - pair_shift_)) - 1U)]);
    }
    kept = 0;
    return more(std::exchange(entries, 0U));
  };
  for (std::uint32_t b = 0; b < batch.buckets; ++b) {
    const Asked& asked = batch.asked[b];
    std::uint32_t left = asked.count;
    for (std::uint32_t c = asked.head; left > 0; c = chunks[c].next()) {
      const Chunk& chunk = chunks[c];
      // The head's chunk holds what is left over when the others are full.
      const std::uint32_t count = (left - 1) % kChunkEntries + 1;
      left -= count;
      entries += count;
      __builtin_prefetch(&chunks[left > 0 ? chunk.next() : 0]);
      const Refused refused = refuse(chunk, asked, layout);
      for (std::uint32_t i = 0; i < count; ++i) {
        if (refused[i] >= 0) {
          batch.kept[kept++] = chunk.words[i];
          __builtin_prefetch(stars_.data() + std::size_t{chunk.words[i] >> apex_shift_} * neighbours_);
        }
      }
      if (kept > kKept - kChunkEntries && !visit_kept()) {
        return false;
      }
    }
  }
  batch.buckets = 0;
  return visit_kept();
}

/// Negative for each entry that is out of a range or of another row of cells; four at once.
inline LandmarkIndex::Refused LandmarkIndex::refuse(const Chunk& chunk, const Asked& asked,
                                                    const Layout& layout) noexcept {
  Refused refused;  // NOLINT: written next
  for (std::size_t i = 0; i < refused.size(); i += kLanes) {
    Lanes entry;  // NOLINT: the same
    std::memcpy(&entry, &chunk.words[i], sizeof(entry));
    const Lanes tag = (entry >> layout.tag_shift) & layout.tag_mask;
    const Lanes l = (entry >> layout.longest_shift) & layout.low_mask;
    const Lanes m = (entry >> layout.middle_shift) & layout.low_mask;
    const Lanes s = entry & layout.low_mask;
    const Lanes out = -(tag ^ asked.tag) | (l - asked.longest.low) | (asked.longest.high - l) |
                      (m - asked.middle.low) | (asked.middle.high - m) | (s - asked.shortest.low) |
                      (asked.shortest.high - s);
    std::memcpy(&refused[i], &out, sizeof(out));
  }
  return refused;
}

}  // namespace slamsensor::core
