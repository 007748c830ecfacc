#include "core/association/landmark_index.hpp"

#include "core/memory/assert.hpp"

#include <bit>

namespace slamsensor::core {
namespace {

// Share of the pairs of neighbours whose triangle has its longest side opposite the landmark: those seen at
// more than about 60 degrees from each other.
constexpr double kTrianglesPerPair = 0.62;
// Chunks are filled to this share on average; buckets that hold few entries waste most of one.
constexpr double kChunkFill = 0.85;
constexpr std::uint32_t kBucketChunks = 2'048;
constexpr double kRelinkMoveTolerances = 0.25;

std::uint32_t neighbours_of(const AssociationConfig& config) noexcept {
  return std::clamp(config.index_neighbours, 3U, LandmarkIndex::kNeighboursMax);
}

std::size_t chunks_for(const AssociationConfig& config, const Capacities& capacities,
                       std::size_t chunk_entries) noexcept {
  const double k = neighbours_of(config);
  const double entries = kTrianglesPerPair * 0.5 * k * (k - 1.0) * capacities.map_landmarks;
  return kBucketChunks +
         static_cast<std::size_t>(entries / (kChunkFill * static_cast<double>(chunk_entries)));
}

}  // namespace

LandmarkIndex::LandmarkIndex(Arena& arena, const AssociationConfig& config,
                             const Capacities& capacities) noexcept
    : neighbours_max_(neighbours_of(config)),
      side_min_m_(std::min(kSideMin * config.tolerance_m, kSideMinLargest_m)),
      relink_move_m_(kRelinkMoveTolerances * config.tolerance_m),
      cell_shift_(64U -
                  static_cast<std::uint32_t>(std::bit_width(std::max(capacities.map_landmarks, 2U) - 1U))),
      cells_(arena, "index: cells", std::size_t{1} << (64U - cell_shift_)),
      places_(arena, "index: places", capacities.map_landmarks),
      links_(arena, "index: links", capacities.map_landmarks),
      buckets_(arena, "index: triangle buckets", bucket_at(kBucketRows, 0)),
      chunks_(arena, "index: triangles", chunks_for(config, capacities, kChunkEntries)) {
  SLAMSENSOR_ASSERT(cells_.try_resize(cells_.capacity()) && places_.try_resize(places_.capacity()) &&
                    links_.try_resize(links_.capacity()) && buckets_.try_resize(buckets_.capacity()) &&
                    chunks_.try_resize(chunks_.capacity()));
  if (!arena.measuring()) {
    clear();
  }
}

void LandmarkIndex::clear() noexcept {
  std::fill(cells_.begin(), cells_.end(), kNone);
  std::fill(buckets_.begin(), buckets_.end(), kNone);
  for (Place& place : places_) {
    place.is_listed = 0;
  }
  free_chunks_ = kNone;
  chunks_used_ = 0;
  size_ = 0;
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

void LandmarkIndex::insert(std::uint32_t slot, MapSlot map, const Point2& p) noexcept {
  SLAMSENSOR_ASSERT(places_[slot].is_listed == 0);
  places_[slot] = {static_cast<float>(p.x()), static_cast<float>(p.y()), kNone, map, 1};
  put_in_cell(slot);
  ++size_;
  link(slot);
}

void LandmarkIndex::move(std::uint32_t slot, const Point2& p) noexcept {
  Place& place = places_[slot];
  SLAMSENSOR_ASSERT(place.is_listed != 0);
  const auto x = static_cast<float>(p.x());
  const auto y = static_cast<float>(p.y());
  if (cell_floor(x) != cell_floor(place.x_m) || cell_floor(y) != cell_floor(place.y_m)) {
    take_from_cell(slot);
    place.x_m = x;
    place.y_m = y;
    put_in_cell(slot);
  } else {
    place.x_m = x;
    place.y_m = y;
  }
  const auto dx = static_cast<double>(x - links_[slot].x_m);
  const auto dy = static_cast<double>(y - links_[slot].y_m);
  if (dx * dx + dy * dy > relink_move_m_ * relink_move_m_) {
    unlink_from_others(slot);
    unlist_triangles(slot);
    link(slot);
  }
}

void LandmarkIndex::erase(std::uint32_t slot) noexcept {
  SLAMSENSOR_ASSERT(places_[slot].is_listed != 0);
  take_from_cell(slot);
  places_[slot].is_listed = 0;
  --size_;
  unlink_from_others(slot);
  unlist_triangles(slot);
}

/// Finds the landmark's neighbours, becomes a neighbour of those that it is nearer to than one of theirs, and
/// lists its triangles.
void LandmarkIndex::link(std::uint32_t slot) noexcept {
  Links& links = links_[slot];
  links.x_m = places_[slot].x_m;
  links.y_m = places_[slot].y_m;
  links.count = 0;
  find_neighbours(slot);
  const float reach2 = links.count < neighbours_max_ ? static_cast<float>(kLinkRange_m * kLinkRange_m)
                                                     : distance2(slot, links.neighbours[links.count - 1]);
  const double reach_m = std::min(kLinkRange_m, 2.0 * static_cast<double>(std::sqrt(reach2)));
  visit_within(places_[slot].map, {places_[slot].x_m, places_[slot].y_m}, reach_m,
               [&](std::uint32_t other, double) { offer_neighbour(other, slot); });
  list_triangles(slot);
}

/// The nearest in rings of cells, until no nearer one can come.
void LandmarkIndex::find_neighbours(std::uint32_t slot) noexcept {
  const Place& own = places_[slot];
  std::array<Found, kNeighboursMax> best{};
  std::uint32_t count = 0;
  const auto side_min2 = static_cast<float>(side_min_m_ * side_min_m_);
  const auto offer = [&](std::uint32_t other) {
    const float d2 = distance2(slot, other);
    if (other == slot || places_[other].map != own.map || d2 < side_min2 ||
        d2 > static_cast<float>(kLinkRange_m * kLinkRange_m) ||
        (count == neighbours_max_ && d2 >= best[count - 1].distance2_m2)) {
      return;
    }
    std::uint32_t place = count < neighbours_max_ ? count++ : count - 1;
    for (; place > 0 && best[place - 1].distance2_m2 > d2; --place) {
      best[place] = best[place - 1];
    }
    best[place] = {other, d2};
  };
  const std::int64_t column = cell_floor(own.x_m);
  const std::int64_t row = cell_floor(own.y_m);
  const auto visit_cell = [&](std::int64_t c, std::int64_t r) {
    for (std::uint32_t other = cells_[cell_of(own.map, c, r)]; other != kNone; other = places_[other].next) {
      if (cell_floor(places_[other].x_m) == c && cell_floor(places_[other].y_m) == r) {
        offer(other);
      }
    }
  };
  const auto rings = static_cast<std::int64_t>(kLinkRange_m / kCellSide_m) + 1;
  for (std::int64_t ring = 0; ring <= rings; ++ring) {
    const double seen_m = static_cast<double>(ring - 1) * kCellSide_m;
    if (count == neighbours_max_ && ring > 1 &&
        static_cast<double>(best[count - 1].distance2_m2) <= seen_m * seen_m) {
      break;
    }
    for (std::int64_t c = column - ring; c <= column + ring; ++c) {
      const bool is_side = c == column - ring || c == column + ring;
      for (std::int64_t r = row - ring; r <= row + ring; r += is_side || ring == 0 ? 1 : 2 * ring) {
        visit_cell(c, r);
      }
    }
  }
  Links& links = links_[slot];
  links.count = count;
  for (std::uint32_t i = 0; i < count; ++i) {
    links.neighbours[i] = best[i].slot;
  }
}

/// Makes `slot` a neighbour of `to` when it is one of the nearest; neighbours stay sorted by distance.
void LandmarkIndex::offer_neighbour(std::uint32_t to, std::uint32_t slot) noexcept {
  const auto d2 = static_cast<double>(distance2(to, slot));
  Links& links = links_[to];
  if (to == slot || d2 < side_min_m_ * side_min_m_ || d2 > kLinkRange_m * kLinkRange_m ||
      (links.count == neighbours_max_ &&
       d2 >= static_cast<double>(distance2(to, links.neighbours[links.count - 1])))) {
    return;
  }
  unlist_triangles(to);
  std::uint32_t place = links.count < neighbours_max_ ? links.count++ : links.count - 1;
  for (; place > 0 && static_cast<double>(distance2(to, links.neighbours[place - 1])) > d2; --place) {
    links.neighbours[place] = links.neighbours[place - 1];
  }
  links.neighbours[place] = slot;
  list_triangles(to);
}

/// Takes the landmark out of the lists of all others; those look for another neighbour in its stead.
void LandmarkIndex::unlink_from_others(std::uint32_t slot) noexcept {
  const Links& own = links_[slot];
  // The places may have moved a little since they were linked.
  visit_within(places_[slot].map, {own.x_m, own.y_m}, kLinkRange_m + 2.0 * relink_move_m_,
               [&](std::uint32_t other, double) {
                 Links& links = links_[other];
                 const auto* const end = links.neighbours.begin() + links.count;
                 if (other == slot || std::find(links.neighbours.begin(),
                                                links.neighbours.begin() + links.count, slot) == end) {
                   return;
                 }
                 unlist_triangles(other);
                 find_neighbours(other);
                 // Landmarks that moved meanwhile may have come nearer; a moved one must not find itself
                 // again.
                 auto* const last =
                     std::remove(links.neighbours.begin(), links.neighbours.begin() + links.count, slot);
                 links.count = static_cast<std::uint32_t>(last - links.neighbours.begin());
                 list_triangles(other);
               });
}

/// The bucket and entry of the triangle of `apex` with its neighbours i and j, as they were linked. False
/// when its corner is not opposite the longest side.
bool LandmarkIndex::shape_of(std::uint32_t apex, std::uint32_t i, std::uint32_t j,
                             Shape& shape) const noexcept {
  const Links& a = links_[apex];
  const auto side = [](const Links& p, const Links& q) {
    const float dx = p.x_m - q.x_m;
    const float dy = p.y_m - q.y_m;
    return std::sqrt(dx * dx + dy * dy);
  };
  float middle_m = side(a, links_[a.neighbours[i]]);
  float shortest_m = side(a, links_[a.neighbours[j]]);
  if (middle_m < shortest_m) {
    std::swap(middle_m, shortest_m);
    std::swap(i, j);
  }
  const Links& b = links_[a.neighbours[i]];
  const Links& c = links_[a.neighbours[j]];
  const float longest_m = side(b, c);
  if (longest_m < middle_m) {
    return false;
  }
  const auto longest = static_cast<std::uint32_t>(longest_m * kFinePerM);
  const auto middle = static_cast<std::uint32_t>(middle_m * kFinePerM);
  const auto shortest = static_cast<std::uint32_t>(shortest_m * kFinePerM);
  const std::uint32_t row = longest / kFinePerBucket;
  const std::uint32_t column = middle / kFinePerBucket;
  if (row >= kBucketRows || shortest >= 4096U) {
    return false;
  }
  const float turn = (b.x_m - a.x_m) * (c.y_m - a.y_m) - (b.y_m - a.y_m) * (c.x_m - a.x_m);
  shape.bucket = bucket_at(row, column);
  shape.packed = (shortest << 20U) | ((longest % kFinePerBucket) << 15U) |
                 ((middle % kFinePerBucket) << 10U) | (i << 4U) | (j << 1U) | (turn > 0.0F ? 1U : 0U);
  return true;
}

void LandmarkIndex::list_triangles(std::uint32_t slot) noexcept {
  Shape shape{};
  for (std::uint32_t i = 0; i < links_[slot].count; ++i) {
    for (std::uint32_t j = i + 1; j < links_[slot].count; ++j) {
      if (shape_of(slot, i, j, shape)) {
        add_entry(shape, slot);
      }
    }
  }
}

void LandmarkIndex::unlist_triangles(std::uint32_t slot) noexcept {
  Shape shape{};
  for (std::uint32_t i = 0; i < links_[slot].count; ++i) {
    for (std::uint32_t j = i + 1; j < links_[slot].count; ++j) {
      if (shape_of(slot, i, j, shape)) {
        remove_entry(shape, slot);
      }
    }
  }
}

void LandmarkIndex::add_entry(const Shape& shape, std::uint32_t apex) noexcept {
  std::uint32_t& head = buckets_[shape.bucket];
  if (head == kNone || chunks_[head].count == kChunkEntries) {
    std::uint32_t fresh = free_chunks_;
    if (fresh != kNone) {
      free_chunks_ = chunks_[fresh].next;
    } else if (chunks_used_ < chunks_.size()) {
      fresh = chunks_used_++;
    } else {
      ++triangles_dropped_;
      return;
    }
    chunks_[fresh].next = head;
    chunks_[fresh].count = 0;
    head = fresh;
  }
  Chunk& chunk = chunks_[head];
  chunk.entries[chunk.count++] = {apex, shape.packed};
}

/// The last entry of the first chunk takes the place of the one that goes.
void LandmarkIndex::remove_entry(const Shape& shape, std::uint32_t apex) noexcept {
  const std::uint32_t head = buckets_[shape.bucket];
  for (std::uint32_t c = head; c != kNone; c = chunks_[c].next) {
    Chunk& chunk = chunks_[c];
    for (std::uint32_t i = 0; i < chunk.count; ++i) {
      if (chunk.entries[i].apex != apex || chunk.entries[i].packed != shape.packed) {
        continue;
      }
      Chunk& first = chunks_[head];
      chunk.entries[i] = first.entries[--first.count];
      if (first.count == 0) {
        buckets_[shape.bucket] = first.next;
        first.next = free_chunks_;
        free_chunks_ = head;
      }
      return;
    }
  }
}

std::uint32_t LandmarkIndex::nearest_within(MapSlot map, const Point2& p, double radius_m,
                                            double& distance2_m2) const noexcept {
  std::uint32_t best = kNone;
  visit_within(map, p, radius_m, [&](std::uint32_t slot, double d2) {
    if (best == kNone || d2 < distance2_m2) {
      best = slot;
      distance2_m2 = d2;
    }
  });
  return best;
}

std::uint64_t LandmarkIndex::triangle_entries(const Sides& sides, float window_m) const noexcept {
  // One bucket stands for all: a guess is enough to order by.
  const auto row_of = [](float side_m) {
    return std::min(static_cast<std::uint32_t>(side_m * kBucketsPerM), kBucketRows - 1);
  };
  std::uint64_t count = 0;
  const std::uint32_t row = row_of(sides.longest_m);
  for (std::uint32_t c = buckets_[bucket_at(row, std::min(row, row_of(sides.middle_m)))]; c != kNone;
       c = chunks_[c].next) {
    count += chunks_[c].count;
  }
  return count *
         static_cast<std::uint64_t>(std::max(1.0F, 4.0F * window_m * window_m * kBucketsPerM * kBucketsPerM));
}

}  // namespace slamsensor::core
