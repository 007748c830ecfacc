#include "core/association/landmark_index.hpp"

#include "core/memory/assert.hpp"

#include <bit>

namespace slamsensor::core {
namespace {

constexpr double kUnitsPerTolerance = 8.0;  // of sides in an entry
constexpr std::uint32_t kLowBitsMost = 3;   // of a side in an entry: a bucket is as wide as the tolerance
constexpr std::uint32_t kTagBitsMost = 8;
// Share of the pairs of neighbours whose triangle has its longest side opposite the landmark: those seen at
// more than about 60 degrees from each other.
constexpr double kTrianglesPerPair = 0.62;
constexpr double kEntriesPerBucket = 10.0;
// A bucket's last chunk is filled by half on average; this much more where landmarks stand in rows or crowds.
constexpr double kChunkReserve = 1.1;
constexpr std::uint32_t kBucketsMin = 64;
constexpr std::uint32_t kCellsMin = 64;
constexpr double kGoldenShare = 0.6180339887;  // of all cells: multiples of it leave no large gaps
constexpr double kRelinkMoveTolerances = 0.25;
constexpr double kJumpMoves = 2.0;           // a longer move is an erasure and an insertion
constexpr double kStepsPerRelinkMove = 4.0;  // in which the place of linking is kept
constexpr double kGroundTolerances = 1.4;    // within which the ground says whether a landmark may be near
// What a landmark may move before its ground is drawn again, and the step in which that is known.
constexpr double kGroundSlackMoves = 1.8;

std::uint32_t neighbours_of(const AssociationConfig& config) noexcept {
  return std::clamp(config.index_neighbours, LandmarkIndex::kNeighboursMin, LandmarkIndex::kNeighboursMax);
}

std::uint32_t bits_for(std::uint32_t count) noexcept {
  return static_cast<std::uint32_t>(std::bit_width(std::max(count, 2U) - 1U));
}

std::uint32_t pair_bits(const AssociationConfig& config) noexcept {
  const std::uint32_t k = neighbours_of(config);
  return bits_for(k * (k - 1) / 2);
}

double entries_for(const AssociationConfig& config, const Capacities& capacities) noexcept {
  const double k = neighbours_of(config);
  return kTrianglesPerPair * 0.5 * k * (k - 1.0) * capacities.map_landmarks;
}

std::uint32_t buckets_for(const AssociationConfig& config, const Capacities& capacities) noexcept {
  const double wanted = entries_for(config, capacities) / kEntriesPerBucket;
  return std::bit_ceil(std::max(kBucketsMin, static_cast<std::uint32_t>(wanted / std::sqrt(2.0))));
}

/// Twice as many cells where the buckets, whose number is a power of two as well, leave the memory for it.
std::uint32_t cells_for(const AssociationConfig& config, const Capacities& capacities) noexcept {
  constexpr double kBytesPerCell = 12.0;
  constexpr double kBytesPerBucket = 24.0;  // with the half of a chunk that is empty
  const double bytes_most = (10.0 + 5.0 * neighbours_of(config)) * capacities.map_landmarks;
  const std::uint32_t many = std::bit_ceil(std::max(kCellsMin, capacities.map_landmarks));
  const double bytes = kBytesPerCell * many + kBytesPerBucket * buckets_for(config, capacities);
  return bytes <= bytes_most ? many : std::bit_floor(std::max(kCellsMin, capacities.map_landmarks));
}

std::size_t chunks_for(const AssociationConfig& config, const Capacities& capacities,
                       double chunk_entries) noexcept {
  const double entries = kChunkReserve * entries_for(config, capacities);
  return static_cast<std::size_t>(entries / chunk_entries + 0.5 * buckets_for(config, capacities)) +
         kBucketsMin;
}

}  // namespace

LandmarkIndex::LandmarkIndex(Arena& arena, const AssociationConfig& config,
                             const Capacities& capacities) noexcept
    : neighbours_(neighbours_of(config)),
      side_min_m_(std::min(kSideMin * config.tolerance_m, kSideMinLargest_m)),
      relink_move_m_(kRelinkMoveTolerances * config.tolerance_m),
      units_per_m_(static_cast<float>(kUnitsPerTolerance / config.tolerance_m)),
      pair_shift_(0),
      apex_shift_(32U - bits_for(capacities.map_landmarks)),
      low_bits_(std::min(kLowBitsMost, (apex_shift_ - pair_bits(config)) / 3U)),
      tag_mask_(0),
      cell_mask_(cells_for(config, capacities) - 1U),
      cell_stride_(static_cast<std::uint32_t>(kGoldenShare * (cell_mask_ + 1.0)) | 1U),
      bucket_mask_(buckets_for(config, capacities) - 1U),
      ground_reach_m_(kGroundTolerances * config.tolerance_m),
      ground_radius_m_(ground_reach_m_ + kGroundSlackMoves * relink_move_m_),
      cells_(arena, "index: cells", std::size_t{cell_mask_} + 1U),
      ground_(arena, "index: ground", std::size_t{cell_mask_} + 1U),
      places_(arena, "index: places", capacities.map_landmarks),
      stars_(arena, "index: stars", std::size_t{neighbours_} * capacities.map_landmarks),
      buckets_(arena, "index: triangle buckets", std::size_t{bucket_mask_} + 1U),
      chunks_(arena, "index: triangles", chunks_for(config, capacities, kChunkEntries)) {
  const std::uint32_t tag_bits = std::min(kTagBitsMost, apex_shift_ - pair_bits(config) - 3U * low_bits_);
  tag_mask_ = (1U << tag_bits) - 1U;
  pair_shift_ = 3U * low_bits_ + tag_bits;
  apex_shift_ = pair_shift_ + pair_bits(config);
  SLAMSENSOR_ASSERT(apex_shift_ + bits_for(capacities.map_landmarks) <= 32U);
  if (ground_radius_m_ + relink_move_m_ > kCellSide_m) {
    ground_reach_m_ = 0.0;  // more than the cells about a landmark would say so
  }
  SLAMSENSOR_ASSERT(cells_.try_resize(cells_.capacity()) && ground_.try_resize(ground_.capacity()) &&
                    places_.try_resize(places_.capacity()) && stars_.try_resize(stars_.capacity()) &&
                    buckets_.try_resize(buckets_.capacity()) && chunks_.try_resize(chunks_.capacity()));
  if (!arena.measuring()) {
    clear();
  }
}

void LandmarkIndex::clear() noexcept {
  std::fill(cells_.begin(), cells_.end(), kNone);
  std::fill(ground_.begin(), ground_.end(), 0U);
  std::fill(buckets_.begin(), buckets_.end(), Bucket{});
  for (Place& place : places_) {
    place.is_listed = 0;
  }
  free_chunks_ = kNone;
  chunks_used_ = 0;
  size_ = 0;
  triangles_ = 0;
}

float LandmarkIndex::distance2(std::uint32_t a, std::uint32_t b) const noexcept {
  const float dx = places_[a].x_m - places_[b].x_m;
  const float dy = places_[a].y_m - places_[b].y_m;
  return dx * dx + dy * dy;
}

void LandmarkIndex::put_in_cell(std::uint32_t slot) noexcept {
  Place& place = places_[slot];
  std::uint32_t& head = cells_[cell_of(place.map, cell_floor(place.x_m), cell_floor(place.y_m))];
  place.next = head;
  head = slot;
}

void LandmarkIndex::take_from_cell(std::uint32_t slot) noexcept {
  const Place& place = places_[slot];
  std::uint32_t* link = &cells_[cell_of(place.map, cell_floor(place.x_m), cell_floor(place.y_m))];
  while (*link != slot) {
    link = &places_[*link].next;
  }
  *link = place.next;
}

/// Remembers where the landmark stands, to a quarter of the way that it may move before it is linked anew.
void LandmarkIndex::note_linked(Place& place) const noexcept {
  const double steps_per_m = kStepsPerRelinkMove / relink_move_m_;
  place.linked_x = static_cast<std::uint8_t>(floor_of(static_cast<double>(place.x_m) * steps_per_m));
  place.linked_y = static_cast<std::uint8_t>(floor_of(static_cast<double>(place.y_m) * steps_per_m));
}

bool LandmarkIndex::has_moved(const Place& place) const noexcept {
  Place now = place;
  note_linked(now);
  const auto dx = static_cast<std::int8_t>(static_cast<std::uint8_t>(now.linked_x - place.linked_x));
  const auto dy = static_cast<std::int8_t>(static_cast<std::uint8_t>(now.linked_y - place.linked_y));
  return static_cast<double>(dx * dx + dy * dy) > kStepsPerRelinkMove * kStepsPerRelinkMove;
}

/// Where the landmark stood when it was linked, to a step.
Point2 LandmarkIndex::linked_place(const Place& place) const noexcept {
  const double step_m = relink_move_m_ / kStepsPerRelinkMove;
  Place now = place;
  note_linked(now);
  const auto dx = static_cast<std::int8_t>(static_cast<std::uint8_t>(place.linked_x - now.linked_x));
  const auto dy = static_cast<std::int8_t>(static_cast<std::uint8_t>(place.linked_y - now.linked_y));
  return Point2(static_cast<double>(place.x_m), static_cast<double>(place.y_m)) + step_m * Point2(dx, dy);
}

/// The ground about a landmark at `p` that lies in a cell.
std::uint64_t LandmarkIndex::ground_of(const Point2& p, std::int32_t column,
                                       std::int32_t row) const noexcept {
  const double side_m = 1.0 / kGroundPerM;
  const double x = p.x() - column * kCellSide_m;
  const double y = p.y() - row * kCellSide_m;
  std::uint64_t word = 0;
  for (std::int32_t line = 0; line < kGroundSide; ++line) {
    const double dy = std::max({0.0, line * side_m - y, y - (line + 1) * side_m});
    const double half2 = ground_radius_m_ * ground_radius_m_ - dy * dy;
    if (half2 <= 0.0) {
      continue;
    }
    const double half = std::sqrt(half2);
    const std::int32_t first = std::max(0, floor_of((x - half) * kGroundPerM));
    const std::int32_t last = std::min(kGroundSide - 1, floor_of((x + half) * kGroundPerM));
    if (first <= last) {
      const std::uint64_t bits = ((std::uint64_t{1} << static_cast<std::uint32_t>(last - first + 1)) - 1U)
                                 << static_cast<std::uint32_t>(first);
      word |= bits << static_cast<std::uint32_t>(line << kGroundShift);
    }
  }
  return word;
}

/// The word of a cell, from all landmarks in it and about it, and in and about those that share it.
std::uint64_t LandmarkIndex::ground_about(MapSlot map, std::int32_t column, std::int32_t row) const noexcept {
  std::uint64_t word = 0;
  for (std::int32_t r = -1; r <= 1; ++r) {
    for (std::int32_t c = -1; c <= 1; ++c) {
      for (std::uint32_t slot = cells_[cell_of(map, column + c, row + r)]; slot != kNone;
           slot = places_[slot].next) {
        const Place& place = places_[slot];
        word |= ground_of(linked_place(place), cell_floor(place.x_m) - c, cell_floor(place.y_m) - r);
      }
    }
  }
  return word;
}

/// Calls `visit(column, row)` for the cells with ground about `p`.
template <typename Visit>
void LandmarkIndex::visit_ground_cells(const Point2& p, Visit&& visit) const noexcept {
  const std::int32_t column_last = cell_floor(p.x() + ground_radius_m_);
  const std::int32_t row_last = cell_floor(p.y() + ground_radius_m_);
  for (std::int32_t row = cell_floor(p.y() - ground_radius_m_); row <= row_last; ++row) {
    for (std::int32_t column = cell_floor(p.x() - ground_radius_m_); column <= column_last; ++column) {
      visit(column, row);
    }
  }
}

void LandmarkIndex::draw_ground(std::uint32_t slot) noexcept {
  const Place& place = places_[slot];
  const Point2 p = linked_place(place);
  visit_ground_cells(p, [&](std::int32_t column, std::int32_t row) {
    ground_[cell_of(place.map, column, row)] |= ground_of(p, column, row);
  });
}

/// What lay about `p` has changed.
void LandmarkIndex::redraw_ground(MapSlot map, const Point2& p) noexcept {
  visit_ground_cells(p, [&](std::int32_t column, std::int32_t row) {
    ground_[cell_of(map, column, row)] = ground_about(map, column, row);
  });
}

void LandmarkIndex::insert(std::uint32_t slot, MapSlot map, const Point2& p) noexcept {
  SLAMSENSOR_ASSERT(places_[slot].is_listed == 0 && map <= UINT8_MAX);
  places_[slot] = {
      static_cast<float>(p.x()), static_cast<float>(p.y()), kNone, static_cast<std::uint8_t>(map), 1, 0, 0};
  put_in_cell(slot);
  ++size_;
  make_star(slot);
  draw_ground(slot);
  offer_to_others(slot);
}

void LandmarkIndex::move(std::uint32_t slot, const Point2& p) noexcept {
  Place& place = places_[slot];
  SLAMSENSOR_ASSERT(place.is_listed != 0);
  const auto x = static_cast<float>(p.x());
  const auto y = static_cast<float>(p.y());
  const auto dx = static_cast<double>(x - place.x_m);
  const auto dy = static_cast<double>(y - place.y_m);
  if (dx * dx + dy * dy > kJumpMoves * kJumpMoves * relink_move_m_ * relink_move_m_) {
    const MapSlot map = place.map;  // others know it by its place
    erase(slot);
    insert(slot, map, p);
    return;
  }
  const bool changes_cell = cell_floor(x) != cell_floor(place.x_m) || cell_floor(y) != cell_floor(place.y_m);
  if (changes_cell) {
    take_from_cell(slot);
  }
  place.x_m = x;
  place.y_m = y;
  if (changes_cell) {
    put_in_cell(slot);
  }
  if (has_moved(place)) {
    const Point2 before = linked_place(place);
    drop_star(slot);
    make_star(slot);
    redraw_ground(place.map, before);
    draw_ground(slot);
    refresh_others(slot);
  }
}

void LandmarkIndex::erase(std::uint32_t slot) noexcept {
  SLAMSENSOR_ASSERT(places_[slot].is_listed != 0);
  drop_star(slot);
  take_from_cell(slot);
  redraw_ground(places_[slot].map, linked_place(places_[slot]));
  unlink_from_others(slot);
  places_[slot].is_listed = 0;
  --size_;
}

/// The nearest in rings of cells, until no nearer one can come.
void LandmarkIndex::find_neighbours(std::uint32_t slot, std::array<Found, kNeighboursMax>& best,
                                    std::uint32_t& count) const noexcept {
  const Place& own = places_[slot];
  count = 0;
  const auto side_min2 = static_cast<float>(side_min_m_ * side_min_m_);
  const auto offer = [&](std::uint32_t other) {
    const float d2 = distance2(slot, other);
    if (other == slot || places_[other].map != own.map || d2 < side_min2 ||
        d2 > static_cast<float>(kLinkRange_m * kLinkRange_m) ||
        (count == neighbours_ && d2 >= best[count - 1].distance2_m2)) {
      return;
    }
    std::uint32_t place = count < neighbours_ ? count++ : count - 1;
    for (; place > 0 && best[place - 1].distance2_m2 > d2; --place) {
      best[place] = best[place - 1];
    }
    best[place] = {other, d2};
  };
  const std::int32_t column = cell_floor(own.x_m);
  const std::int32_t row = cell_floor(own.y_m);
  const auto visit_cell = [&](std::int32_t c, std::int32_t r) {
    for (std::uint32_t other = cells_[cell_of(own.map, c, r)]; other != kNone; other = places_[other].next) {
      if (cell_floor(places_[other].x_m) == c && cell_floor(places_[other].y_m) == r) {
        offer(other);
      }
    }
  };
  const auto rings = static_cast<std::int32_t>(kLinkRange_m / kCellSide_m) + 1;
  for (std::int32_t ring = 0; ring <= rings; ++ring) {
    const double seen_m = static_cast<double>(ring - 1) * kCellSide_m;
    if (count == neighbours_ && ring > 1 &&
        static_cast<double>(best[count - 1].distance2_m2) <= seen_m * seen_m) {
      break;
    }
    for (std::int32_t c = column - ring; c <= column + ring; ++c) {
      const bool is_side = c == column - ring || c == column + ring;
      for (std::int32_t r = row - ring; r <= row + ring; r += is_side || ring == 0 ? 1 : 2 * ring) {
        visit_cell(c, r);
      }
    }
  }
}

LandmarkIndex::Offset LandmarkIndex::offset_between(std::uint32_t from, std::uint32_t to) const noexcept {
  const auto steps = [](float d_m) {
    return static_cast<std::int16_t>(floor_of(static_cast<double>(d_m * kOffsetsPerM) + 0.5));
  };
  return {steps(places_[to].x_m - places_[from].x_m), steps(places_[to].y_m - places_[from].y_m)};
}

/// Links the landmark to its neighbours and lists its triangles.
void LandmarkIndex::make_star(std::uint32_t slot) noexcept {
  std::array<Found, kNeighboursMax> best{};
  std::uint32_t count = 0;
  find_neighbours(slot, best, count);
  const std::span<Offset> star = star_at(slot);
  for (std::uint32_t ray = 0; ray < neighbours_; ++ray) {
    star[ray] = ray < count ? offset_between(slot, best[ray].slot) : Offset{};
  }
  note_linked(places_[slot]);
  Shape shape{};
  for (std::uint32_t j = 1; j < count; ++j) {
    for (std::uint32_t i = 0; i < j; ++i) {
      if (shape_of(slot, i, j, shape)) {
        add_entry(shape);
      }
    }
  }
}

void LandmarkIndex::drop_star(std::uint32_t slot) noexcept {
  for (std::uint32_t ray = 0; ray < neighbours_; ++ray) {
    set_ray(slot, ray, Offset{});
  }
}

/// Another neighbour in place of one of the star's, or none. Its triangles follow.
void LandmarkIndex::set_ray(std::uint32_t slot, std::uint32_t ray, Offset offset) noexcept {
  Shape shape{};
  const auto each_triangle = [&](auto&& change) {
    for (std::uint32_t other = 0; other < neighbours_; ++other) {
      if (other != ray && shape_of(slot, std::min(ray, other), std::max(ray, other), shape)) {
        change(shape);
      }
    }
  };
  each_triangle([&](const Shape& s) { remove_entry(s); });
  star_at(slot)[ray] = offset;
  each_triangle([&](const Shape& s) { add_entry(s); });
}

/// The landmark becomes a neighbour of those that it is nearer to than one of theirs.
void LandmarkIndex::offer_to_others(std::uint32_t slot) noexcept {
  float farthest2_m2 = 0.0F;
  bool is_full = true;
  for (const Offset& offset : star(slot)) {
    farthest2_m2 = std::max(farthest2_m2, offset.x_m() * offset.x_m() + offset.y_m() * offset.y_m());
    is_full = is_full && offset.is_some();
  }
  const double reach_m =
      is_full ? std::min(kLinkRange_m, 2.0 * static_cast<double>(std::sqrt(farthest2_m2))) : kLinkRange_m;
  visit_within(places_[slot].map, place(slot), reach_m,
               [&](std::uint32_t other, double) { offer(other, slot); });
}

void LandmarkIndex::offer(std::uint32_t to, std::uint32_t slot) noexcept {
  const auto d2 = static_cast<double>(distance2(to, slot));
  if (to == slot || d2 < side_min_m_ * side_min_m_ || d2 > kLinkRange_m * kLinkRange_m) {
    return;
  }
  std::uint32_t farthest = 0;
  double farthest2_m2 = -1.0;
  const std::span<const Offset> rays = star(to);
  for (std::uint32_t ray = 0; ray < rays.size(); ++ray) {
    const auto x = static_cast<double>(rays[ray].x_m());
    const auto y = static_cast<double>(rays[ray].y_m());
    const double ray2_m2 = rays[ray].is_some() ? x * x + y * y : 1e12;
    if (ray2_m2 > farthest2_m2) {
      farthest = ray;
      farthest2_m2 = ray2_m2;
    }
  }
  if (d2 < farthest2_m2) {
    set_ray(to, farthest, offset_between(to, slot));
  }
}

/// The ray of `from` that leads to `to`; the number of neighbours when there is none. Both may have moved a
/// little since they were linked.
std::uint32_t LandmarkIndex::ray_to(std::uint32_t from, std::uint32_t to) const noexcept {
  const double steps = 4.5 * relink_move_m_ * static_cast<double>(kOffsetsPerM);
  const double x = static_cast<double>((places_[to].x_m - places_[from].x_m) * kOffsetsPerM);
  const double y = static_cast<double>((places_[to].y_m - places_[from].y_m) * kOffsetsPerM);
  const std::span<const Offset> rays = star(from);
  std::uint32_t best = neighbours_;
  double best2 = steps * steps;
  for (std::uint32_t ray = 0; ray < neighbours_; ++ray) {
    const double dx = static_cast<double>(rays[ray].x) - x;
    const double dy = static_cast<double>(rays[ray].y) - y;
    if (rays[ray].is_some() && dx * dx + dy * dy <= best2) {
      best = ray;
      best2 = dx * dx + dy * dy;
    }
  }
  return best;
}

/// Those that are linked to the landmark hear where it stands now; others may find it nearer than before.
void LandmarkIndex::refresh_others(std::uint32_t slot) noexcept {
  visit_within(places_[slot].map, place(slot), kLinkRange_m, [&](std::uint32_t other, double) {
    if (other == slot) {
      return;
    }
    const std::uint32_t ray = ray_to(other, slot);
    if (ray == neighbours_) {
      offer(other, slot);
    } else {
      set_ray(other, ray, offset_between(other, slot));
    }
  });
}

/// Takes the landmark out of the stars of all others; those look for another neighbour in its stead. It is
/// not found by its place any more.
void LandmarkIndex::unlink_from_others(std::uint32_t slot) noexcept {
  visit_within(places_[slot].map, place(slot), kLinkRange_m + 5.0 * relink_move_m_,
               [&](std::uint32_t other, double) {
                 const std::uint32_t ray = other == slot ? neighbours_ : ray_to(other, slot);
                 if (ray == neighbours_) {
                   return;
                 }
                 std::array<Found, kNeighboursMax> best{};
                 std::uint32_t count = 0;
                 find_neighbours(other, best, count);
                 set_ray(other, ray, Offset{});
                 for (std::uint32_t i = 0; i < count; ++i) {
                   if (ray_to(other, best[i].slot) == neighbours_) {
                     set_ray(other, ray, offset_between(other, best[i].slot));
                     break;
                   }
                 }
               });
}

/// The bucket and entry of the triangle of `apex` with its rays i < j. False when its corner is not opposite
/// the longest side.
bool LandmarkIndex::shape_of(std::uint32_t apex, std::uint32_t i, std::uint32_t j,
                             Shape& shape) const noexcept {
  const Offset p = star(apex)[i];
  const Offset q = star(apex)[j];
  if (!p.is_some() || !q.is_some()) {
    return false;
  }
  const auto length2 = [](std::int32_t x, std::int32_t y) {
    return std::int64_t{x} * x + std::int64_t{y} * y;
  };
  const std::int64_t p2 = length2(p.x, p.y);
  const std::int64_t q2 = length2(q.x, q.y);
  const std::int64_t far2 = std::max(p2, q2);
  const std::int64_t longest2 = length2(p.x - q.x, p.y - q.y);
  if (longest2 < far2) {
    return false;
  }
  const auto units = [&](std::int64_t side2) {
    return static_cast<std::uint32_t>(std::sqrt(static_cast<float>(side2)) * (units_per_m_ / kOffsetsPerM));
  };
  const Units sides{units(longest2), units(far2), units(std::min(p2, q2))};
  const std::int64_t cross = std::int64_t{p.x} * q.y - std::int64_t{p.y} * q.x;  // the farther one first
  const std::uint32_t turn = (p2 >= q2) == (cross > 0) ? 1U : 0U;
  const std::uint32_t low = low_bits_;
  const Entry mask = (Entry{1} << low) - 1U;
  const std::uint32_t row = row_of(sides.longest >> low, sides.middle >> low, turn);
  shape.bucket = bucket_of(row, sides.shortest >> low);
  shape.entry = (apex << apex_shift_) | ((j * (j - 1) / 2 + i) << pair_shift_) |
                (static_cast<Entry>(tag_of(row)) << (3 * low)) | ((sides.longest & mask) << (2 * low)) |
                ((sides.middle & mask) << low) | (sides.shortest & mask);
  return true;
}

void LandmarkIndex::add_entry(const Shape& shape) noexcept {
  Bucket& bucket = buckets_[shape.bucket];
  const std::uint32_t at = bucket.count % kChunkEntries;
  if (at == 0) {  // all its chunks are full
    std::uint32_t fresh = free_chunks_;
    if (fresh != kNone) {
      free_chunks_ = chunks_[fresh].next();
    } else if (chunks_used_ < chunks_.size()) {
      fresh = chunks_used_++;
    } else {
      ++triangles_dropped_;
      return;
    }
    chunks_[fresh].set_next(bucket.head);
    bucket.head = fresh;
  }
  chunks_[bucket.head].words[at] = shape.entry;
  ++bucket.count;
  ++triangles_;
}

/// The last entry of the first chunk takes the place of the one that goes. An entry that found no room is not
/// there.
void LandmarkIndex::remove_entry(const Shape& shape) noexcept {
  Bucket& bucket = buckets_[shape.bucket];
  std::uint32_t left = bucket.count;
  for (std::uint32_t c = bucket.head; left > 0; c = chunks_[c].next()) {
    Chunk& chunk = chunks_[c];
    const std::uint32_t count = (left - 1) % kChunkEntries + 1;
    left -= count;
    auto* const end = chunk.words.begin() + count;
    auto* const entry = std::find(chunk.words.begin(), end, shape.entry);
    if (entry == end) {
      continue;
    }
    Chunk& first = chunks_[bucket.head];
    --bucket.count;
    --triangles_;
    *entry = first.words[bucket.count % kChunkEntries];
    if (bucket.count % kChunkEntries == 0) {
      const std::uint32_t empty = bucket.head;
      bucket.head = first.next();
      first.set_next(free_chunks_);
      free_chunks_ = empty;
    }
    return;
  }
}

std::uint32_t LandmarkIndex::nearest_within(MapSlot map, const Point2& p, double radius_m,
                                            double& distance2_m2) const noexcept {
  std::uint32_t best = kNone;
  if (radius_m <= ground_reach_m_ && !may_be_near(map, p)) {
    return best;
  }
  visit_within(map, p, radius_m, [&](std::uint32_t slot, double d2) {
    if (best == kNone || d2 < distance2_m2) {
      best = slot;
      distance2_m2 = d2;
    }
  });
  return best;
}

std::uint32_t LandmarkIndex::bucket_entries(const Sides& sides, bool is_counter_clockwise) const noexcept {
  const auto cell = [&](float side_m) { return range_of(side_m, 0.0F).low >> low_bits_; };
  return buckets_[bucket_of(
                      row_of(cell(sides.longest_m), cell(sides.middle_m), is_counter_clockwise ? 1U : 0U),
                      cell(sides.shortest_m))]
      .count;
}

}  // namespace slamsensor::core
