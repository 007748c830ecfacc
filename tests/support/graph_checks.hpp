#pragma once

#include "core/graph/delaunay.hpp"
#include "tests/support/graph_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace slamsensor::tests {

/// What a triangulation is checked against, by definition and by brute force, with predicates of its own.
__extension__ typedef __int128 Wide;
using Place = std::pair<std::int64_t, std::int64_t>;
using IndexEdge = std::pair<std::uint32_t, std::uint32_t>;

inline std::vector<Place> places_of(const Points& points) {
  std::vector<Place> places;
  for (const core::Point2& p : points) {
    places.emplace_back(std::llround(p.x() * 1024.0), std::llround(p.y() * 1024.0));
  }
  return places;
}

/// The first point at each place.
inline std::map<Place, std::uint32_t> first_at(const std::vector<Place>& places) {
  std::map<Place, std::uint32_t> first;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    first.emplace(places[i], i);
  }
  return first;
}

inline Wide doubled_area(const Place& a, const Place& b, const Place& c) {
  return Wide{b.first - a.first} * (c.second - a.second) - Wide{b.second - a.second} * (c.first - a.first);
}

/// Positive when d lies inside the circle of the counter-clockwise triangle abc (the determinant of lifted
/// points).
inline Wide in_circle_determinant(const Place& a, const Place& b, const Place& c, const Place& d) {
  std::array<std::array<Wide, 3>, 3> m{};
  const std::array<Place, 3> corners{a, b, c};
  for (std::size_t i = 0; i < 3; ++i) {
    const Wide x = corners[i].first - d.first;
    const Wide y = corners[i].second - d.second;
    m[i] = {x, y, x * x + y * y};
  }
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/// The boundary of the convex hull as directed edges, counter-clockwise, with the places on its sides; empty
/// when all lie on a line.
inline std::set<IndexEdge> hull_of(const std::map<Place, std::uint32_t>& first) {
  std::vector<std::pair<Place, std::uint32_t>> sorted(first.begin(), first.end());
  std::set<IndexEdge> hull;
  for (int side = 0; side < 2; ++side) {
    std::vector<std::pair<Place, std::uint32_t>> chain;
    for (const auto& next : sorted) {
      while (chain.size() > 1 &&
             doubled_area(chain[chain.size() - 2].first, chain.back().first, next.first) < 0) {
        chain.pop_back();
      }
      chain.push_back(next);
    }
    for (std::size_t i = 1; i < chain.size(); ++i) {
      hull.emplace(chain[i - 1].second, chain[i].second);
    }
    std::reverse(sorted.begin(), sorted.end());
  }
  return hull;
}

/// Fails unless each place that has several points contributes exactly the edges from its first to the
/// others, and returns all other edges.
inline std::set<IndexEdge> expect_twin_edges(const std::vector<Place>& places,
                                             const std::map<Place, std::uint32_t>& first,
                                             std::span<const core::Delaunay::Edge> edges) {
  std::set<IndexEdge> twins;
  std::set<IndexEdge> mesh;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const IndexEdge edge{edges[i].a, edges[i].b};
    EXPECT_LT(edge.first, edge.second);
    if (i > 0) {
      EXPECT_LT((IndexEdge{edges[i - 1].a, edges[i - 1].b}), edge) << "edges are not sorted or come twice";
    }
    (places.at(edge.first) == places.at(edge.second) ? twins : mesh).insert(edge);
  }
  std::set<IndexEdge> expected;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    if (first.at(places[i]) != i) {
      expected.emplace(first.at(places[i]), i);
    }
  }
  EXPECT_EQ(twins, expected);
  return mesh;
}

/// Fails unless the circle of every triangle is empty of `places`.
inline void expect_empty_circles(const std::vector<Place>& places, const core::Delaunay& delaunay) {
  for (const auto& [a, b, c] : delaunay.triangles()) {
    for (const Place& p : places) {
      ASSERT_LE(in_circle_determinant(places[a], places[b], places[c], p), 0)
          << "triangle " << a << ' ' << b << ' ' << c;
    }
  }
}

/// Fails unless the triangles cover the convex hull of the first points once: all counter-clockwise, the
/// edges that have a triangle on one side only are the hull's, and the areas add up. The edges are those of
/// the triangles.
inline void expect_covers_hull(const std::vector<Place>& places, const std::map<Place, std::uint32_t>& first,
                               const core::Delaunay& delaunay, const std::set<IndexEdge>& mesh) {
  std::set<IndexEdge> directed;
  std::set<IndexEdge> undirected;
  Wide area = 0;
  for (const auto& corner : delaunay.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = corner[i];
      const std::uint32_t to = corner[(i + 1) % 3];
      EXPECT_EQ(first.at(places.at(from)), from);
      EXPECT_TRUE(directed.emplace(from, to).second) << "two triangles left of an edge";
      undirected.emplace(std::min(from, to), std::max(from, to));
    }
    const Wide part = doubled_area(places[corner[0]], places[corner[1]], places[corner[2]]);
    EXPECT_GT(part, 0);
    area += part;
  }
  EXPECT_EQ(undirected, mesh);
  const std::set<IndexEdge> hull = hull_of(first);
  std::set<IndexEdge> border;
  for (const IndexEdge& edge : directed) {
    if (!directed.contains({edge.second, edge.first})) {
      border.insert(edge);
    }
  }
  EXPECT_EQ(border, hull);
  for (const auto& [from, to] : hull) {
    area -= Wide{places[from].first} * places[to].second - Wide{places[to].first} * places[from].second;
  }
  EXPECT_EQ(static_cast<std::int64_t>(area), 0) << "the triangles overlap or leave a hole";
  EXPECT_EQ(delaunay.triangles().size(), 2 * first.size() - 2 - hull.size()) << "Euler";
  EXPECT_EQ(mesh.size(), 3 * first.size() - 3 - hull.size()) << "Euler";
}

/// Fails unless `delaunay`, just built from `points`, is their Delaunay triangulation; the points must not be
/// collinear.
inline void expect_delaunay(const Points& points, const core::Delaunay& delaunay) {
  const std::vector<Place> places = places_of(points);
  const std::map<Place, std::uint32_t> first = first_at(places);
  const std::set<IndexEdge> mesh = expect_twin_edges(places, first, delaunay.edges());
  expect_covers_hull(places, first, delaunay, mesh);
  expect_empty_circles(places, delaunay);
}

}  // namespace slamsensor::tests
