#include "core/graph/delaunay.hpp"

#include "core/graph/radix_sort.hpp"
#include "core/graph/spatial_order.hpp"
#include "core/memory/assert.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <optional>
#include <utility>

namespace slamsensor::core {
namespace {

// A planar graph of m > 2 vertices has at most 3 m - 6 edges, fewer points than that one each, and every twin
// adds one.
constexpr std::uint32_t kEdgesPerPoint = 3;
constexpr std::uint32_t kIndexBits = 32;

// The first place, the first that differs from it, and the first that is not on the line through both: none
// when all places are collinear.
std::optional<std::array<std::uint32_t, 3>> first_triangle(std::span<const LatticePoint> places) noexcept {
  std::uint32_t second = 1;
  while (second < places.size() && places[second] == places[0]) {
    ++second;
  }
  for (std::uint32_t third = second + 1; third < places.size(); ++third) {
    if (orientation(places[0], places[second], places[third]) != 0) {
      return std::array<std::uint32_t, 3>{0, second, third};
    }
  }
  return std::nullopt;
}

}  // namespace

Delaunay::Delaunay(Arena& arena, std::uint32_t points_max) noexcept
    : given_(arena, "delaunay places, given order", points_max),
      places_(arena, "delaunay places", points_max),
      origin_(arena, "delaunay origins", points_max),
      twins_(arena, "delaunay twins", points_max),
      keys_(arena, "delaunay sort keys", std::size_t{points_max} * kEdgesPerPoint),
      scratch_(arena, "delaunay sort scratch", std::size_t{points_max} * kEdgesPerPoint),
      triangulation_(arena, points_max),
      triangles_(arena, "delaunay triangles", std::size_t{points_max} * 2),
      edges_(arena, "delaunay edges", std::size_t{points_max} * kEdgesPerPoint),
      mesh_(arena, points_max, points_max * kEdgesPerPoint) {
}

bool Delaunay::build(std::span<const Point2> points) noexcept {
  triangles_.clear();
  edges_.clear();
  twins_.clear();
  const bool taken = take_places(points);
  if (taken && triangulate()) {
    collect_triangles();
    collect_edges();
  } else if (taken) {
    chain();
  }
  sort_edges();
  mesh_.rebuild(taken ? static_cast<std::uint32_t>(points.size()) : 0, edges_.span());
  return taken;
}

bool Delaunay::take_places(std::span<const Point2> points) noexcept {
  if (points.size() > given_.capacity() || !std::all_of(points.begin(), points.end(), on_lattice)) {
    return false;
  }
  given_.clear();
  for (const Point2& point : points) {
    const bool fits = given_.try_push_back(to_lattice(point));
    SLAMSENSOR_ASSERT(fits);
  }
  const bool fits = keys_.try_resize(points.size()) && scratch_.try_resize(scratch_.capacity());
  SLAMSENSOR_ASSERT(fits);
  return true;
}

// False when all places are collinear.
bool Delaunay::triangulate() noexcept {
  spatial_order(given_.span(), keys_.span(), scratch_.span());
  places_.clear();
  origin_.clear();
  for (const std::uint64_t key : keys_) {
    const auto index = static_cast<std::uint32_t>(key);
    const bool fits = places_.try_push_back(given_[index]) && origin_.try_push_back(index);
    SLAMSENSOR_ASSERT(fits);
  }
  const auto corners = first_triangle(places_.span());
  if (!corners) {
    return false;
  }
  triangulation_.start(places_.span(), *corners);
  for (std::uint32_t vertex = 1; vertex < places_.size(); ++vertex) {
    if (vertex != (*corners)[1] && vertex != (*corners)[2]) {
      insert(vertex);
    }
  }
  return true;
}

// A vertex stands for the earliest of the points at its place, whichever of them came first along the curve.
void Delaunay::insert(std::uint32_t vertex) noexcept {
  const std::uint32_t standing = triangulation_.insert(vertex);
  if (standing == vertex) {
    return;
  }
  if (origin_[vertex] < origin_[standing]) {
    std::swap(origin_[vertex], origin_[standing]);
  }
  const bool fits = twins_.try_push_back({origin_[vertex], standing});
  SLAMSENSOR_ASSERT(fits);
}

// The mesh of collinear points: each place joined to the next along the line.
void Delaunay::chain() noexcept {
  line_order(given_.span(), keys_.span(), scratch_.span());
  std::uint32_t standing = 0;  // the first point at the place before
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const auto point = static_cast<std::uint32_t>(keys_[i]);
    if (i > 0) {
      add_edge(standing, point);
    }
    if (i == 0 || given_[point] != given_[standing]) {
      standing = point;
    }
  }
}

void Delaunay::collect_triangles() noexcept {
  for (const Triangulation::Face& face : triangulation_.faces()) {
    if (!face.is_ghost()) {
      const auto [a, b, c] = face.corner;
      const bool fits = triangles_.try_push_back({origin_[a], origin_[b], origin_[c]});
      SLAMSENSOR_ASSERT(fits);
    }
  }
}

// Every edge has a face on either side; the one with the lower index adds it.
void Delaunay::collect_edges() noexcept {
  const auto faces = triangulation_.faces();
  for (std::uint32_t index = 0; index < faces.size(); ++index) {
    const auto& [corner, across] = faces[index];
    for (std::size_t slot = 0; slot < 3; ++slot) {
      const std::uint32_t u = corner[(slot + 1) % 3];
      const std::uint32_t v = corner[(slot + 2) % 3];
      if (index < across[slot] && u != Triangulation::kInfinity && v != Triangulation::kInfinity) {
        add_edge(origin_[u], origin_[v]);
      }
    }
  }
  for (const Twin& twin : twins_) {
    add_edge(origin_[twin.vertex], twin.point);
  }
}

void Delaunay::add_edge(std::uint32_t a, std::uint32_t b) noexcept {
  const bool fits = edges_.try_push_back({std::min(a, b), std::max(a, b)});
  SLAMSENSOR_ASSERT(fits);
}

void Delaunay::sort_edges() noexcept {
  const bool fits = keys_.try_resize(edges_.size());
  SLAMSENSOR_ASSERT(fits);
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    keys_[i] = (std::uint64_t{edges_[i].a} << kIndexBits) | edges_[i].b;
  }
  const auto index_bits = static_cast<std::uint32_t>(std::bit_width(given_.size()));
  radix_sort(keys_.span(), scratch_.span(), 0, index_bits);
  radix_sort(keys_.span(), scratch_.span(), kIndexBits, kIndexBits + index_bits);
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    edges_[i] = {static_cast<std::uint32_t>(keys_[i] >> kIndexBits), static_cast<std::uint32_t>(keys_[i])};
  }
}

}  // namespace slamsensor::core
