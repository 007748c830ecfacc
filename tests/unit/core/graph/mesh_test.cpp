#include "core/graph/mesh.hpp"

#include "tests/support/graph_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::tests {
namespace {

using core::Mesh;
using core::MeshEdge;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::pair<std::uint32_t, std::uint32_t>> visits(Mesh& mesh, std::uint32_t from,
                                                            std::uint32_t depth) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
  for (const auto [vertex, steps] : mesh.within(from, depth)) {
    result.emplace_back(vertex, steps);
  }
  return result;
}

// A ring of six with a tail 5 - 6, and 7 alone.
const std::vector<MeshEdge> kRing{{0, 1}, {0, 5}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}};

TEST(Mesh, ListsNeighboursAscending) {
  InArena<Mesh> mesh(8U, 7U);
  mesh->rebuild(8, kRing);
  EXPECT_THAT(mesh->neighbours(0), ElementsAre(1, 5));
  EXPECT_THAT(mesh->neighbours(5), ElementsAre(0, 4, 6));
  EXPECT_THAT(mesh->neighbours(6), ElementsAre(5));
  EXPECT_THAT(mesh->neighbours(7), IsEmpty());
}

TEST(Mesh, WithinCountsTheShortestWay) {
  InArena<Mesh> mesh(8U, 7U);
  mesh->rebuild(8, kRing);
  EXPECT_THAT(visits(*mesh, 0, 0), IsEmpty());
  EXPECT_THAT(visits(*mesh, 7, 9), IsEmpty());
  EXPECT_THAT(visits(*mesh, 1, 1), ElementsAre(std::pair(0U, 1U), std::pair(2U, 1U)));
  EXPECT_THAT(visits(*mesh, 6, 3), ElementsAre(std::pair(5U, 1U), std::pair(0U, 2U), std::pair(4U, 2U),
                                               std::pair(1U, 3U), std::pair(3U, 3U)));
  EXPECT_THAT(visits(*mesh, 6, 0xFFFF'FFFF), testing::SizeIs(6));
}

TEST(Mesh, RebuildForgetsWhatWas) {
  InArena<Mesh> mesh(8U, 7U);
  mesh->rebuild(8, kRing);
  EXPECT_THAT(visits(*mesh, 0, 2), testing::SizeIs(5));
  mesh->rebuild(3, std::vector<MeshEdge>{{0, 2}});
  EXPECT_EQ(mesh->vertex_count(), 3U);
  EXPECT_THAT(visits(*mesh, 0, 2), ElementsAre(std::pair(2U, 1U)));
  EXPECT_THAT(mesh->neighbours(1), IsEmpty());
  mesh->rebuild(0, {});
  EXPECT_EQ(mesh->vertex_count(), 0U);
}

}  // namespace
}  // namespace slamsensor::tests
