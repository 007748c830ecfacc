#include "tools/world/world.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

WorldConfig exact_world() {
  WorldConfig config;
  config.trees.radius_m = {0.2, 0.2};
  config.trees.crown_stops_per_m = 0.0;
  config.rangefinder.noise_sigma_m = 0.0;
  config.rangefinder.resolution_m = 0.0;
  return config;
}

World make(const WorldConfig& config) {
  auto world = World::create(config);
  EXPECT_TRUE(world.has_value()) << world.error().message;
  return std::move(*world);
}

const Eigen::Vector3d kEye_W(0.0, 0.0, 1.5);

TEST(World, KnownTreeAtKnownDistance) {
  WorldConfig config = exact_world();
  config.stems = {{3.0, 4.0}, {6.0, 8.0}};
  const World world = make(config);
  Random rng(1);
  const Range range = world.cast(kEye_W, {0.6, 0.8, 0.0}, 0.0, rng);
  EXPECT_EQ(range.surface, Surface::Stem);
  EXPECT_EQ(range.index, 0U);
  EXPECT_NEAR(range.range_m, 4.8, 1e-12);
}

TEST(World, TreesStandOnTheUnevenGround) {
  WorldConfig config = exact_world();
  config.ground.slope_x = 0.1;
  config.trees.height_m = {3.0, 3.0};
  config.stems = {{20.0, 0.0}};
  const World world = make(config);
  const auto surface_at = [&world](double z_m) {
    return world.trace({{19.0, 0.0, z_m}, {1, 0, 0}}, 0.0, 300.0, 1).surface;
  };
  EXPECT_EQ(surface_at(4.99), Surface::Stem);  // 2 m of ground and 3 m of tree
  EXPECT_NE(surface_at(5.01), Surface::Stem);
}

TEST(World, SkyGivesNoReturn) {
  const World world = make(exact_world());
  Random rng(1);
  const Range range = world.cast(kEye_W, Eigen::Vector3d(1, 0, 0.1).normalized(), 0.0, rng);
  EXPECT_FALSE(range.has_return());
  EXPECT_EQ(range.surface, Surface::None);
}

TEST(World, NearestOfGroundObjectWallAndMover) {
  WorldConfig config = exact_world();
  config.stems = {{30.0, 0.0}};
  const Eigen::Vector3d down = Eigen::Vector3d(20.0, 0, -1.5).normalized();  // meets the ground at 20 m
  EXPECT_EQ(make(config).trace({kEye_W, down}, 0.0, 300.0, 1).surface, Surface::Ground);
  config.stems = {{15.0, 0.0}};
  EXPECT_EQ(make(config).trace({kEye_W, down}, 0.0, 300.0, 1).surface, Surface::Stem);
  config.walls.push_back({12.0, -1.0, 12.0, 1.0, 2.0});
  EXPECT_EQ(make(config).trace({kEye_W, down}, 0.0, 300.0, 1).surface, Surface::Wall);
  MoverConfig person;
  person.x1_m = person.x2_m = 10.0;
  config.movers.push_back(person);
  EXPECT_EQ(make(config).trace({kEye_W, down}, 0.0, 300.0, 1).surface, Surface::Person);
}

TEST(World, DropOutsComeInTheirShare) {
  WorldConfig config = exact_world();
  config.stems = {{5.0, 0.0}};
  config.rangefinder.drop_out_share = 0.1;
  const World world = make(config);
  Random rng(2);
  int lost = 0;
  constexpr int kShots = 20'000;
  for (int i = 0; i < kShots; ++i) {
    lost += world.cast(kEye_W, {1, 0, 0}, 0.0, rng).has_return() ? 0 : 1;
  }
  EXPECT_NEAR(static_cast<double>(lost) / kShots, 0.1, 0.01);
}

TEST(World, WideBeamAtAnEdgeReadsNearFarAndBetween) {
  WorldConfig config = exact_world();
  config.walls = {{10.0, 0.0, 10.0, 5.0, 5.0}, {20.0, -20.0, 20.0, 20.0, 5.0}};
  config.rangefinder.divergence_rad = 0.02;
  config.rangefinder.sub_rays = 8;
  const World world = make(config);
  Random rng(5);
  int near = 0;
  int far = 0;
  int between = 0;
  for (int i = 0; i < 1000; ++i) {
    const double range_m = world.cast(kEye_W, {1, 0, 0}, 0.0, rng).range_m;
    near += std::abs(range_m - 10.0) < 0.01 ? 1 : 0;
    far += std::abs(range_m - 20.0) < 0.01 ? 1 : 0;
    between += range_m > 10.5 && range_m < 19.5 ? 1 : 0;
  }
  EXPECT_EQ(near + far + between, 1000);
  EXPECT_GT(near, 50);
  EXPECT_GT(far, 50);
  EXPECT_NEAR(between, 500, 80);  // mixed_share
}

TEST(World, EqualSeedsEqualReadings) {
  WorldConfig config;
  config.trees.density_per_ha = 50.0;
  config.bushes.density_per_ha = 50.0;
  config.ground.amplitude_m = 0.5;
  const World a = make(config);
  const World b = make(config);
  Random rng_a(3);
  Random rng_b(3);
  for (int i = 0; i < 5000; ++i) {
    const double pan = 0.001 * i;
    const Eigen::Vector3d direction_W(std::cos(pan), std::sin(pan), 0.0);
    EXPECT_EQ(a.cast(kEye_W, direction_W, i, rng_a).range_m, b.cast(kEye_W, direction_W, i, rng_b).range_m);
  }
}

TEST(World, InsideObjectsIsNotFree) {
  WorldConfig config = exact_world();
  config.stems = {{5.0, 5.0}};
  const World world = make(config);
  EXPECT_FALSE(world.is_free({5.0, 5.1}, 0.0));
  EXPECT_FALSE(world.is_free({5.0, 6.1}, 1.0));
  EXPECT_TRUE(world.is_free({5.0, 6.3}, 1.0));
}

TEST(World, RefusesWhatIsOutOfRange) {
  WorldConfig config;
  config.rangefinder.range_max_m = 0.0;
  const auto world = World::create(config);
  ASSERT_FALSE(world.has_value());
  EXPECT_EQ(world.error().message, "rangefinder.range_max_m = 0 is out of range: 1 to 5000");
  config = WorldConfig{};
  config.trees.density_per_ha = std::nan("");
  EXPECT_FALSE(World::create(config).has_value());
  config = WorldConfig{};
  config.trees.radius_m = {0.4, 0.2};
  EXPECT_FALSE(World::create(config).has_value());
  config = WorldConfig{};
  config.trees.density_per_ha = 20'000.0;
  config.area = {-1e4, 1e4, -1e4, 1e4, 0.0};
  EXPECT_FALSE(World::create(config).has_value());
}

}  // namespace
}  // namespace slamsensor::tools
