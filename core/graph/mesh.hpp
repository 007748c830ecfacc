#pragma once

#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// An undirected edge between two vertices, a < b.
struct MeshEdge {
  std::uint32_t a;
  std::uint32_t b;

  friend bool operator==(const MeshEdge&, const MeshEdge&) noexcept = default;
};

/// Who adjoins whom in an undirected graph, and who can be reached in a few steps. It owns the scratch of the
/// search, so that the landmark graphs of all hypotheses share one.
class Mesh {
 public:
  struct Visit {
    std::uint32_t vertex;
    std::uint32_t steps;  ///< length of the shortest way, in edges
  };

  Mesh(Arena& arena, std::uint32_t vertices_max, std::uint32_t edges_max) noexcept;

  /// Takes over `edges`, sorted and each once, between vertices below `vertex_count`; both must be within
  /// capacity.
  void rebuild(std::uint32_t vertex_count, std::span<const MeshEdge> edges) noexcept;

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return vertex_count_; }

  /// The vertices that share an edge with `vertex`, ascending.
  [[nodiscard]] std::span<const std::uint32_t> neighbours(std::uint32_t vertex) const noexcept;

  /// The other vertices at most `depth` steps from `vertex`, each once, by non-decreasing steps; none when
  /// `depth` is 0. Valid until the next call.
  [[nodiscard]] std::span<const Visit> within(std::uint32_t vertex, std::uint32_t depth) noexcept;

 private:
  void begin_visits() noexcept;

  std::uint32_t vertex_count_ = 0;
  BoundedVector<std::uint32_t>
      offsets_;  // neighbours of v: adjacent_[offsets_[v]] up to adjacent_[offsets_[v + 1]]
  BoundedVector<std::uint32_t> adjacent_;
  BoundedVector<std::uint32_t> visited_;  // the stamp of the search that reached the vertex last
  BoundedVector<Visit> queue_;
  std::uint32_t stamp_ = 0;
};

}  // namespace slamsensor::core
