#include "tools/world/population.hpp"

#include "tools/world/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

WorldConfig mixed_world(std::uint64_t seed) {
  WorldConfig config;
  config.seed = seed;
  config.area = {-60.0, 60.0, -50.0, 50.0, 0.4};
  config.trees.density_per_ha = 120.0;
  config.trees.spacing_m = 3.0;
  config.bushes.density_per_ha = 100.0;
  config.rocks.density_per_ha = 60.0;
  config.posts.density_per_ha = 30.0;
  config.walls.push_back({-20.0, 10.0, 25.0, 18.0, 2.0});
  return config;
}

Population populate(const WorldConfig& config) {
  return tools::populate(config, Ground(config.ground, config.seed));
}

class PopulationOfSeed : public testing::TestWithParam<std::uint64_t> {};

TEST_P(PopulationOfSeed, KeepsGapsAndSpacing) {
  SCOPED_TRACE(GetParam());
  const WorldConfig config = mixed_world(GetParam());
  const Population population = populate(config);
  const auto& objects = population.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const core::Point2 a(objects[i].x_m, objects[i].y_m);
    EXPECT_TRUE(config.area.contains(a.x(), a.y()));
    EXPECT_GE(distance_to_wall_m(a, config.walls[0]), objects[i].radius_m + 0.4);
    for (std::size_t j = 0; j < i; ++j) {
      const double distance_m = (core::Point2(objects[j].x_m, objects[j].y_m) - a).norm();
      EXPECT_GE(distance_m, objects[i].radius_m + objects[j].radius_m + 0.4 - 1e-12);
      if (objects[i].kind == Surface::Stem && objects[j].kind == Surface::Stem) {
        EXPECT_GE(distance_m, 3.0);
      }
    }
  }
}

TEST_P(PopulationOfSeed, ReachesTheDensities) {
  SCOPED_TRACE(GetParam());
  const Population population = populate(mixed_world(GetParam()));
  EXPECT_EQ(population.unplaced, 0U);
  EXPECT_EQ(population.objects.size(), 144U + 120U + 72U + 36U);  // 1.2 ha
}

INSTANTIATE_TEST_SUITE_P(Seeds, PopulationOfSeed, testing::Values(1, 2, 3, 4, 5));

TEST(Population, ChangingOneKindLeavesTheStreamsOfTheOthers) {
  WorldConfig config = mixed_world(6);
  const Population before = populate(config);
  config.bushes.density_per_ha = 0.0;
  const Population after = populate(config);
  for (std::size_t i = 0; i < 144 + 72; ++i) {  // trees and rocks are placed first
    EXPECT_EQ(before.objects[i].x_m, after.objects[i].x_m);
    EXPECT_EQ(before.objects[i].radius_m, after.objects[i].radius_m);
  }
}

// The value pins worlds across compilers, libraries and versions: positions to 0.1 mm.
TEST(Population, SeedOneKeepsItsWorld) {
  std::uint64_t digest = 0;
  for (const Object& object : populate(mixed_world(1)).objects) {
    digest = mix_seed(digest, static_cast<std::uint64_t>(std::llround(object.x_m * 1e4)));
    digest = mix_seed(digest, static_cast<std::uint64_t>(std::llround(object.y_m * 1e4)));
  }
  EXPECT_EQ(digest, 15779770645574973408ULL);
}

TEST(Population, TooDenseIsCountedNotEndless) {
  WorldConfig config;
  config.area = {0.0, 20.0, 0.0, 20.0, 0.5};
  config.trees.density_per_ha = 5000.0;
  config.trees.spacing_m = 4.0;
  const Population population = populate(config);
  EXPECT_EQ(population.objects.size() + population.unplaced, 200U);
  EXPECT_GT(population.unplaced, 100U);
}

TEST(Population, RowsAreASymmetricLattice) {
  WorldConfig config;
  config.area = {0.0, 40.0, 0.0, 30.0, 0.0};
  config.rows.spacing_m = 6.0;
  config.rows.step_m = 4.0;
  const Population population = populate(config);
  EXPECT_EQ(population.objects.size(), 11U * 5U);  // x: 20 +-20 by 4; y: 15 +-12 by 6
  for (const Object& tree : population.objects) {
    const core::Point2 turned(40.0 - tree.x_m, 30.0 - tree.y_m);
    EXPECT_FALSE(population.footprints.is_clear(turned, 0.0));
  }
}

TEST(Population, GivenStemsOutsideTheAreaAreLeftOut) {
  WorldConfig config;
  config.area = {0.0, 10.0, 0.0, 10.0, 0.0};
  config.stems = {{5.0, 5.0}, {11.0, 5.0}, {5.1, 5.0}};
  EXPECT_EQ(populate(config).objects.size(), 2U);
}

TEST(Population, MoversKeepClearOfWhatStands) {
  WorldConfig config = mixed_world(9);
  config.people.count = 8;
  const Population population = populate(config);
  ASSERT_EQ(population.movers.size() + population.unplaced, 8U);
  ASSERT_GT(population.movers.size(), 0U);
  for (const MoverConfig& mover : population.movers) {
    for (double time_s = 0.0; time_s < 120.0; time_s += 0.5) {
      EXPECT_TRUE(population.footprints.is_clear(place_at(mover, time_s).position_W, 0.2)) << time_s;
    }
  }
}

}  // namespace
}  // namespace slamsensor::tools
