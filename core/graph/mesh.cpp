#include "core/graph/mesh.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>
#include <cstddef>

namespace slamsensor::core {

// `offsets_` has two places more than vertices: while the lists are filled, the end of v's list stands at v +
// 1 and counts up from its beginning, which is what the offsets of v + 1 have to be afterwards.
Mesh::Mesh(Arena& arena, std::uint32_t vertices_max, std::uint32_t edges_max) noexcept
    : offsets_(arena, "mesh offsets", std::size_t{vertices_max} + 2),
      adjacent_(arena, "mesh neighbours", std::size_t{edges_max} * 2),
      visited_(arena, "mesh visits", vertices_max),
      queue_(arena, "mesh queue", vertices_max) {
}

void Mesh::rebuild(std::uint32_t vertex_count, std::span<const MeshEdge> edges) noexcept {
  vertex_count_ = vertex_count;
  offsets_.clear();
  adjacent_.clear();
  visited_.clear();
  const bool fits = offsets_.try_resize(std::size_t{vertex_count} + 2, 0) &&
                    adjacent_.try_resize(edges.size() * 2) && visited_.try_resize(vertex_count, 0);
  SLAMSENSOR_ASSERT(fits);
  stamp_ = 0;
  for (const MeshEdge& edge : edges) {
    ++offsets_[std::size_t{edge.a} + 2];
    ++offsets_[std::size_t{edge.b} + 2];
  }
  for (std::size_t i = 2; i < offsets_.size(); ++i) {
    offsets_[i] += offsets_[i - 1];
  }
  // Sorted edges give sorted lists: those to lower vertices come first, by their lower end, then those to
  // higher ones.
  for (const MeshEdge& edge : edges) {
    adjacent_[offsets_[std::size_t{edge.a} + 1]++] = edge.b;
    adjacent_[offsets_[std::size_t{edge.b} + 1]++] = edge.a;
  }
}

std::span<const std::uint32_t> Mesh::neighbours(std::uint32_t vertex) const noexcept {
  SLAMSENSOR_ASSERT(vertex < vertex_count_);
  const std::uint32_t begin = offsets_[vertex];
  return adjacent_.span().subspan(begin, offsets_[std::size_t{vertex} + 1] - begin);
}

std::span<const Mesh::Visit> Mesh::within(std::uint32_t vertex, std::uint32_t depth) noexcept {
  SLAMSENSOR_ASSERT(vertex < vertex_count_);
  begin_visits();
  visited_[vertex] = stamp_;
  bool fits = queue_.try_push_back({vertex, 0});
  for (std::size_t head = 0; head < queue_.size() && queue_[head].steps < depth; ++head) {
    const Visit from = queue_[head];
    for (const std::uint32_t to : neighbours(from.vertex)) {
      if (visited_[to] != stamp_) {
        visited_[to] = stamp_;
        fits = queue_.try_push_back({to, from.steps + 1}) && fits;
      }
    }
  }
  SLAMSENSOR_ASSERT(fits);
  return queue_.span().subspan(1);
}

// A new stamp makes all vertices unvisited at once; only when the stamps run out are they cleared one by one.
void Mesh::begin_visits() noexcept {
  queue_.clear();
  if (++stamp_ == 0) {
    std::fill(visited_.begin(), visited_.end(), 0);
    stamp_ = 1;
  }
}

}  // namespace slamsensor::core
