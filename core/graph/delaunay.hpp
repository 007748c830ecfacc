#pragma once

#include "core/geometry/pose2.hpp"
#include "core/graph/delaunay_triangulation.hpp"
#include "core/graph/lattice.hpp"
#include "core/graph/mesh.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Delaunay triangulation in fixed memory, of the points' lattice places. Exact on collinear, cocircular,
/// duplicate and lattice points; the same points in the same order always give the same result. One thread.
class Delaunay {
 public:
  using Edge = MeshEdge;  ///< indices into the points given to `build`

  Delaunay(Arena& arena, std::uint32_t points_max) noexcept;

  /// Triangulates `points` (m). Afterwards `edges()` holds every edge once, a < b, sorted. Collinear points
  /// give the chain along their line; a point that shares its lattice place with an earlier one gives the
  /// single edge to the first one there, which alone takes part in the triangulation. False, and no edges,
  /// when there are more points than capacity or one is not finite or out of reach.
  [[nodiscard]] bool build(std::span<const Point2> points) noexcept;

  [[nodiscard]] std::span<const Edge> edges() const noexcept { return edges_.span(); }

  /// Corner triples, counter-clockwise, of the last `build`; empty when all points are collinear.
  [[nodiscard]] std::span<const std::array<std::uint32_t, 3>> triangles() const noexcept {
    return triangles_.span();
  }

  /// The edges of the last `build` as neighbour lists, with a search for the points a few steps away.
  [[nodiscard]] Mesh& mesh() noexcept { return mesh_; }

 private:
  struct Twin {
    std::uint32_t point;   // the later point at an occupied place
    std::uint32_t vertex;  // the vertex that occupies it
  };

  [[nodiscard]] bool take_places(std::span<const Point2> points) noexcept;
  [[nodiscard]] bool triangulate() noexcept;
  void insert(std::uint32_t vertex) noexcept;
  void chain() noexcept;
  void collect_triangles() noexcept;
  void collect_edges() noexcept;
  void add_edge(std::uint32_t a, std::uint32_t b) noexcept;
  void sort_edges() noexcept;

  BoundedVector<LatticePoint> given_;    // places in the order of the input
  BoundedVector<LatticePoint> places_;   // places in the order of insertion; the vertices are indices into it
  BoundedVector<std::uint32_t> origin_;  // the input index of each of `places_`
  BoundedVector<Twin> twins_;
  BoundedVector<std::uint64_t> keys_;
  BoundedVector<std::uint64_t> scratch_;
  Triangulation triangulation_;
  BoundedVector<std::array<std::uint32_t, 3>> triangles_;
  BoundedVector<Edge> edges_;
  Mesh mesh_;
};

}  // namespace slamsensor::core
