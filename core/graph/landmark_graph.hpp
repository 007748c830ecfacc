#pragma once

#include "core/geometry/pose2.hpp"
#include "core/graph/delaunay.hpp"
#include "core/graph/edge_limit.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// The graph of a set of landmarks (DESIGN 2.3): an edge joins two landmarks that are at most `depth` steps
/// of the Delaunay mesh apart; its label is their distance. Stored as neighbour lists (CSR), each sorted by
/// length.
class LandmarkGraph {
 public:
  struct Neighbour {
    std::uint32_t vertex;
    float length_m;
  };

  LandmarkGraph(Arena& arena, const char* name, std::uint32_t vertices_max, std::uint32_t edges_max) noexcept;

  /// Rebuilds the graph of `points` (m) with the mesh that `delaunay` computes for them. When the edges do
  /// not fit, the longest of the last mesh step are left out (and of the one before, when even without the
  /// last they do not fit), `edges_dropped()` counts them, exactly the capacity is used, and the graph stays
  /// symmetric. False, and the graph is empty, when the points are more than the capacity or cannot be
  /// triangulated.
  [[nodiscard]] bool build(std::span<const Point2> points, Delaunay& delaunay, std::uint32_t depth) noexcept;

  /// Makes this graph a copy of `other`, which must have the same capacities.
  void copy_from(const LandmarkGraph& other) noexcept;

  [[nodiscard]] std::uint32_t vertex_count() const noexcept { return vertex_count_; }
  [[nodiscard]] std::uint32_t edge_count() const noexcept {  ///< undirected
    return static_cast<std::uint32_t>(neighbours_.size() / 2);
  }
  [[nodiscard]] std::uint32_t edges_dropped() const noexcept { return edges_dropped_; }

  /// Neighbours of `vertex`, by non-decreasing length, equal lengths by vertex. Asserts that there is such a
  /// vertex.
  [[nodiscard]] std::span<const Neighbour> neighbours(std::uint32_t vertex) const noexcept;

 private:
  void clear() noexcept;
  [[nodiscard]] bool fill(std::span<const Point2> points, Mesh& mesh, std::uint32_t depth,
                          const EdgeLimit* limit) noexcept;
  void fill_shortest(std::span<const Point2> points, Mesh& mesh, std::uint32_t depth) noexcept;

  std::uint32_t vertex_count_ = 0;
  std::uint32_t edges_dropped_ = 0;
  BoundedVector<std::uint32_t>
      offsets_;  // neighbours of v: neighbours_[offsets_[v]] up to neighbours_[offsets_[v + 1]]
  BoundedVector<Neighbour> neighbours_;
};

}  // namespace slamsensor::core
