#pragma once

#include "core/graph/lattice.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// A Delaunay triangulation that grows point by point. The outside of the hull is filled with ghost faces:
/// each hull edge carries one, whose third corner is the point at infinity. So the faces cover a sphere,
/// every face has three neighbours, and a point outside the hull is inserted like any other.
class Triangulation {
 public:
  static constexpr std::uint32_t kInfinity = 0xFFFF'FFFF;

  /// Corners counter-clockwise, as indices into the points or kInfinity; `across[i]` is the face beyond the
  /// edge opposite `corner[i]`.
  struct Face {
    std::array<std::uint32_t, 3> corner;
    std::array<std::uint32_t, 3> across;

    [[nodiscard]] bool is_ghost() const noexcept {
      return corner[0] == kInfinity || corner[1] == kInfinity || corner[2] == kInfinity;
    }
  };

  Triangulation(Arena& arena, std::uint32_t points_max) noexcept;

  /// Begins anew with the triangle of three of `points`, which must not lie on a line and must outlive the
  /// insertions. `points` holds at most `points_max`.
  void start(std::span<const LatticePoint> points, std::array<std::uint32_t, 3> corners) noexcept;

  /// Inserts point `vertex` and returns it, or, when a vertex stands at its place already, changes nothing
  /// and returns that one. Exactly Delaunay afterwards. Fast when near the point inserted before.
  std::uint32_t insert(std::uint32_t vertex) noexcept;

  /// All faces, ghosts too: 2 m - 2 of them for m vertices.
  [[nodiscard]] std::span<const Face> faces() const noexcept { return faces_.span(); }

 private:
  [[nodiscard]] std::uint32_t locate(const LatticePoint& p) const noexcept;
  [[nodiscard]] bool in_conflict(const Face& face, const LatticePoint& p) const noexcept;
  void split(std::uint32_t face, std::uint32_t vertex) noexcept;
  void flip(std::uint32_t face) noexcept;
  [[nodiscard]] std::uint32_t restore_around(std::uint32_t face) noexcept;
  [[nodiscard]] std::uint32_t finite_face(std::uint32_t face) const noexcept;
  void replace_neighbour(std::uint32_t face, std::uint32_t old_face, std::uint32_t new_face) noexcept;

  std::span<const LatticePoint> points_;
  BoundedVector<Face> faces_;
  std::uint32_t last_ = 0;  // a finite face near the last insertion
};

}  // namespace slamsensor::core
