#include "core/graph/delaunay_triangulation.hpp"

#include "core/memory/assert.hpp"

#include <utility>

namespace slamsensor::core {
namespace {

using Face = Triangulation::Face;

constexpr std::uint32_t kNone = 0xFFFF'FFFF;

constexpr std::size_t next(std::size_t slot) noexcept {
  return slot == 2 ? 0 : slot + 1;
}
constexpr std::size_t previous(std::size_t slot) noexcept {
  return slot == 0 ? 2 : slot - 1;
}

// The slot of `value`, which is one of the three.
std::size_t slot_of(const std::array<std::uint32_t, 3>& values, std::uint32_t value) noexcept {
  return values[0] == value ? 0 : values[1] == value ? 1 : 2;
}

}  // namespace

// A sphere of m vertices and the point at infinity has 2 (m + 1) - 4 faces.
Triangulation::Triangulation(Arena& arena, std::uint32_t points_max) noexcept
    : faces_(arena, "triangulation faces", std::size_t{2} * points_max) {
}

void Triangulation::start(std::span<const LatticePoint> points,
                          std::array<std::uint32_t, 3> corners) noexcept {
  points_ = points;
  const auto [a, b, c] = corners;
  const std::int64_t turn = orientation(points[a], points[b], points[c]);
  SLAMSENSOR_ASSERT(turn != 0);
  const std::uint32_t u = turn > 0 ? b : c;
  const std::uint32_t v = turn > 0 ? c : b;
  faces_.clear();
  const bool fits = faces_.try_push_back({{a, u, v}, {1, 2, 3}}) &&
                    faces_.try_push_back({{kInfinity, v, u}, {0, 3, 2}}) &&
                    faces_.try_push_back({{kInfinity, a, v}, {0, 1, 3}}) &&
                    faces_.try_push_back({{kInfinity, u, a}, {0, 2, 1}});
  SLAMSENSOR_ASSERT(fits);
  last_ = 0;
}

std::uint32_t Triangulation::insert(std::uint32_t vertex) noexcept {
  const LatticePoint& p = points_[vertex];
  const std::uint32_t found = locate(p);
  for (const std::uint32_t corner : faces_[found].corner) {
    if (corner != kInfinity && points_[corner] == p) {
      return corner;
    }
  }
  split(found, vertex);
  last_ = finite_face(restore_around(found));
  return vertex;
}

// The face that holds `p`, boundary included, or a ghost whose hull edge `p` lies strictly outside of. Walks
// from the last insertion across any edge that separates the face from `p`. In a Delaunay triangulation such
// a walk never returns to a face: the power of `p` to the circumcircle falls with each step or, among
// cocircular faces, the faces form a tree.
std::uint32_t Triangulation::locate(const LatticePoint& p) const noexcept {
  std::uint32_t here = last_;
  std::uint32_t came_from = kNone;
  for (std::size_t step = 0; step <= faces_.size(); ++step) {
    const Face& face = faces_[here];
    if (face.is_ghost()) {
      return here;
    }
    std::uint32_t onward = kNone;
    for (std::size_t slot = 0; slot < 3 && onward == kNone; ++slot) {
      const LatticePoint& u = points_[face.corner[next(slot)]];
      const LatticePoint& v = points_[face.corner[previous(slot)]];
      if (face.across[slot] != came_from && orientation(u, v, p) < 0) {
        onward = face.across[slot];
      }
    }
    if (onward == kNone) {
      return here;
    }
    came_from = std::exchange(here, onward);
  }
  SLAMSENSOR_ASSERT(false);
  return here;
}

// Whether `p` lies strictly inside the circumcircle. A ghost's circle is the open half plane outside its hull
// edge together with the open edge: the limit of the circles through the edge and a point that goes to
// infinity.
bool Triangulation::in_conflict(const Face& face, const LatticePoint& p) const noexcept {
  if (!face.is_ghost()) {
    return in_circle(points_[face.corner[0]], points_[face.corner[1]], points_[face.corner[2]], p);
  }
  const std::size_t infinite = slot_of(face.corner, kInfinity);
  const LatticePoint& u = points_[face.corner[next(infinite)]];
  const LatticePoint& v = points_[face.corner[previous(infinite)]];
  const std::int64_t side = orientation(u, v, p);
  return side > 0 || (side == 0 && strictly_between(u, v, p));
}

// Joins the new vertex p to the corners of face abc, which becomes pbc, pca and pab. Where p lies on an edge
// of abc, one of the three is flat; the circle beyond that edge holds p, so `restore_around` flips it away.
// All faces around p keep p in slot 0.
void Triangulation::split(std::uint32_t face, std::uint32_t vertex) noexcept {
  const Face old = faces_[face];
  const auto [a, b, c] = old.corner;
  const auto pca = static_cast<std::uint32_t>(faces_.size());
  const std::uint32_t pab = pca + 1;
  faces_[face] = {{vertex, b, c}, {old.across[0], pca, pab}};
  const bool fits = faces_.try_push_back({{vertex, c, a}, {old.across[1], pab, face}}) &&
                    faces_.try_push_back({{vertex, a, b}, {old.across[2], face, pca}});
  SLAMSENSOR_ASSERT(fits);
  replace_neighbour(old.across[1], face, pca);
  replace_neighbour(old.across[2], face, pab);
}

// Goes once around the new vertex and flips every edge of its link whose far circle holds it. A flip adds a
// spoke and removes a face in conflict, so flips and spokes together are at most twice the faces. Returns a
// face at the vertex.
std::uint32_t Triangulation::restore_around(std::uint32_t face) noexcept {
  const LatticePoint& p = points_[faces_[face].corner[0]];
  const std::uint32_t first_spoke = faces_[face].corner[1];
  for (std::size_t work = 0; work < 2 * faces_.size(); ++work) {
    if (in_conflict(faces_[faces_[face].across[0]], p)) {
      flip(face);
      continue;
    }
    face = faces_[face].across[1];
    if (faces_[face].corner[1] == first_spoke) {
      return face;
    }
  }
  SLAMSENSOR_ASSERT(false);
  return face;
}

// Turns the edge ab between pab and qba into pq: the faces become paq, in the place of pab, and pqb.
void Triangulation::flip(std::uint32_t face) noexcept {
  Face& near = faces_[face];
  const std::uint32_t far_index = near.across[0];
  Face& far = faces_[far_index];
  const std::size_t apex = slot_of(far.across, face);
  const std::uint32_t p = near.corner[0];
  const std::uint32_t q = far.corner[apex];
  const std::uint32_t b = near.corner[2];
  const std::uint32_t beyond_aq = far.across[next(apex)];
  const std::uint32_t beyond_qb = far.across[previous(apex)];
  const std::uint32_t beyond_bp = near.across[1];
  near = {{p, near.corner[1], q}, {beyond_aq, far_index, near.across[2]}};
  far = {{p, q, b}, {beyond_qb, beyond_bp, face}};
  replace_neighbour(beyond_aq, far_index, face);
  replace_neighbour(beyond_bp, face, far_index);
}

// `face`, or when it is a ghost the finite face on the other side of its hull edge.
std::uint32_t Triangulation::finite_face(std::uint32_t face) const noexcept {
  const Face& f = faces_[face];
  return f.is_ghost() ? f.across[slot_of(f.corner, kInfinity)] : face;
}

void Triangulation::replace_neighbour(std::uint32_t face, std::uint32_t old_face,
                                      std::uint32_t new_face) noexcept {
  auto& across = faces_[face].across;
  across[slot_of(across, old_face)] = new_face;
}

}  // namespace slamsensor::core
