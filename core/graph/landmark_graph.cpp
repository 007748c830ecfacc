#include "core/graph/landmark_graph.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace slamsensor::core {
namespace {

using Neighbour = LandmarkGraph::Neighbour;

constexpr std::size_t kInsertionSortMax = 64;  // a list at depth 2 has about 20 entries

float length_between(const Point2& p, const Point2& q) noexcept {
  return static_cast<float>((p - q).norm());
}

// Orders neighbours by length, equal lengths by vertex: the bits of floats that are not negative order like
// the floats.
std::uint64_t sort_key(const Neighbour& n) noexcept {
  return (std::uint64_t{std::bit_cast<std::uint32_t>(n.length_m)} << 32U) | n.vertex;
}

void insertion_sort(std::span<Neighbour> list) noexcept {
  for (std::size_t i = 1; i < list.size(); ++i) {
    const Neighbour moving = list[i];
    const std::uint64_t key = sort_key(moving);
    std::size_t place = i;
    for (; place > 0 && sort_key(list[place - 1]) > key; --place) {
      list[place] = list[place - 1];
    }
    list[place] = moving;
  }
}

// Heap sort for long lists: in place and, unlike std::sort, without recursion.
void sort_by_length(std::span<Neighbour> list) noexcept {
  if (list.size() <= kInsertionSortMax) {
    insertion_sort(list);
    return;
  }
  const auto nearer = [](const Neighbour& l, const Neighbour& r) { return sort_key(l) < sort_key(r); };
  std::make_heap(list.begin(), list.end(), nearer);
  std::sort_heap(list.begin(), list.end(), nearer);
}

std::uint32_t bits_of(std::uint32_t value) noexcept {
  return static_cast<std::uint32_t>(std::bit_width(value));
}

// Fewer mesh steps first, then the shorter, then by the ends; the same from either end. Indices below
// `vertex_count`.
EdgeRank rank_of(std::uint32_t steps, float length_m, const MeshEdge& edge,
                 std::uint32_t vertex_count) noexcept {
  const std::uint32_t index_bits = bits_of(vertex_count);
  EdgeRank rank = (EdgeRank{steps} << 32U) | std::bit_cast<std::uint32_t>(length_m);
  rank = (rank << index_bits) | edge.a;
  return (rank << index_bits) | edge.b;
}

std::uint32_t rank_bits(std::uint32_t depth, std::uint32_t vertex_count) noexcept {
  return bits_of(std::min(depth, vertex_count)) + 32 + 2 * bits_of(vertex_count);
}

}  // namespace

LandmarkGraph::LandmarkGraph(Arena& arena, const char* name, std::uint32_t vertices_max,
                             std::uint32_t edges_max) noexcept
    : offsets_(arena, name, std::size_t{vertices_max} + 1),
      neighbours_(arena, name, std::size_t{edges_max} * 2) {
}

bool LandmarkGraph::build(std::span<const Point2> points, Delaunay& delaunay, std::uint32_t depth) noexcept {
  clear();
  if (points.size() >= offsets_.capacity() || !delaunay.build(points)) {
    return false;
  }
  vertex_count_ = static_cast<std::uint32_t>(points.size());
  if (!fill(points, delaunay.mesh(), depth, nullptr)) {
    fill_shortest(points, delaunay.mesh(), depth);
  }
  return true;
}

void LandmarkGraph::copy_from(const LandmarkGraph& other) noexcept {
  SLAMSENSOR_ASSERT(offsets_.capacity() == other.offsets_.capacity() &&
                    neighbours_.capacity() == other.neighbours_.capacity());
  vertex_count_ = other.vertex_count_;
  edges_dropped_ = other.edges_dropped_;
  const bool fits = offsets_.assign(other.offsets_.span()) && neighbours_.assign(other.neighbours_.span());
  SLAMSENSOR_ASSERT(fits);
}

std::span<const Neighbour> LandmarkGraph::neighbours(std::uint32_t vertex) const noexcept {
  SLAMSENSOR_ASSERT(vertex < vertex_count_);
  const std::uint32_t begin = offsets_[vertex];
  return neighbours_.span().subspan(begin, offsets_[std::size_t{vertex} + 1] - begin);
}

void LandmarkGraph::clear() noexcept {
  vertex_count_ = 0;
  edges_dropped_ = 0;
  offsets_.clear();
  neighbours_.clear();
}

// Writes every list in turn: the search from a vertex finds all of it, because being so many steps apart is
// mutual. Without a limit all edges are taken, and false says that they did not fit.
bool LandmarkGraph::fill(std::span<const Point2> points, Mesh& mesh, std::uint32_t depth,
                         const EdgeLimit* limit) noexcept {
  neighbours_.clear();
  bool fits = offsets_.try_resize(std::size_t{vertex_count_} + 1);
  SLAMSENSOR_ASSERT(fits);
  offsets_[0] = 0;
  for (std::uint32_t v = 0; v < vertex_count_ && fits; ++v) {
    for (const auto [u, steps] : mesh.within(v, depth)) {
      const float length_m = length_between(points[v], points[u]);
      const MeshEdge edge{std::min(u, v), std::max(u, v)};
      if (limit == nullptr || limit->admits(rank_of(steps, length_m, edge, vertex_count_))) {
        fits = neighbours_.try_push_back({u, length_m}) && fits;
      }
    }
    offsets_[std::size_t{v} + 1] = static_cast<std::uint32_t>(neighbours_.size());
    sort_by_length(neighbours_.span().subspan(offsets_[v]));
  }
  return fits;
}

// Takes as many edges as fit, by rank.
void LandmarkGraph::fill_shortest(std::span<const Point2> points, Mesh& mesh, std::uint32_t depth) noexcept {
  const std::size_t room = neighbours_.capacity() / 2;
  EdgeLimit limit(rank_bits(depth, vertex_count_), room);
  while (!limit.settled()) {
    for (std::uint32_t v = 0; v < vertex_count_; ++v) {
      for (const auto [u, steps] : mesh.within(v, depth)) {
        if (v < u) {
          limit.show(rank_of(steps, length_between(points[v], points[u]), {v, u}, vertex_count_));
        }
      }
    }
    limit.end_pass();
  }
  edges_dropped_ = static_cast<std::uint32_t>(limit.total() - room);
  const bool fits = fill(points, mesh, depth, &limit);
  SLAMSENSOR_ASSERT(fits && neighbours_.size() == 2 * room);
}

}  // namespace slamsensor::core
