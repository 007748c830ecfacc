#include "tools/world/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

World bush(std::uint64_t seed) {
  WorldConfig config;
  config.seed = seed;
  config.area = {-100.0, 100.0, -100.0, 100.0, 0.5};
  config.trees.density_per_ha = 60.0;
  config.bushes.density_per_ha = 60.0;
  config.rocks.density_per_ha = 30.0;
  config.walls.push_back({-50.0, 0.0, 50.0, 0.0, 2.0});
  auto world = World::create(config);
  EXPECT_TRUE(world.has_value());
  return std::move(*world);
}

DriveConfig hundred_stands() {
  DriveConfig drive;
  drive.stands = 100;
  return drive;
}

class DriveOfSeed : public testing::TestWithParam<std::uint64_t> {};

TEST_P(DriveOfSeed, StandsAreClearOfEveryObjectAndTheEdge) {
  SCOPED_TRACE(GetParam());
  const World world = bush(GetParam());
  const auto stands = make_drive(world, hundred_stands(), GetParam());
  ASSERT_TRUE(stands.has_value()) << stands.error().message;
  ASSERT_EQ(stands->size(), 100U);
  for (const Stand& stand : *stands) {
    EXPECT_LE(std::abs(stand.pose.x_m), 90.0);
    EXPECT_LE(std::abs(stand.pose.y_m), 90.0);
    for (const Object& object : world.objects()) {
      EXPECT_GE(std::hypot(object.x_m - stand.pose.x_m, object.y_m - stand.pose.y_m), object.radius_m + 1.0);
    }
  }
}

TEST_P(DriveOfSeed, StepsHaveTheirLengthAndHeadingAndCrossNoWall) {
  SCOPED_TRACE(GetParam());
  const auto stands = make_drive(bush(GetParam()), hundred_stands(), GetParam());
  ASSERT_TRUE(stands.has_value());
  int jumps = 0;
  for (std::size_t i = 1; i < stands->size(); ++i) {
    const core::Pose2& from_W = (*stands)[i - 1].pose;
    const core::Pose2& to_W = (*stands)[i].pose;
    const core::Point2 step = to_W.translation() - from_W.translation();
    if (std::abs(step.norm() - 5.0) > 1e-9) {
      ++jumps;
      continue;
    }
    EXPECT_NEAR(core::wrap_angle(std::atan2(step.y(), step.x()) - to_W.heading_rad), 0.0, 1e-9);
    const bool crosses = from_W.y_m * to_W.y_m < 0.0 && std::abs(from_W.x_m) < 45.0;
    EXPECT_FALSE(crosses);
    EXPECT_EQ((*stands)[i].time_s, 300.0 * static_cast<double>(i));
  }
  EXPECT_LE(jumps, 3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DriveOfSeed, testing::Values(1, 2, 3));

TEST(Drive, EqualSeedsEqualStands) {
  const World world = bush(1);
  const auto a = make_drive(world, hundred_stands(), 7);
  const auto b = make_drive(world, hundred_stands(), 7);
  ASSERT_TRUE(a && b);
  for (std::size_t i = 0; i < a->size(); ++i) {
    EXPECT_EQ((*a)[i].pose.x_m, (*b)[i].pose.x_m);
    EXPECT_EQ((*a)[i].pose.heading_rad, (*b)[i].pose.heading_rad);
  }
}

TEST(Drive, KidnapsComeInTheirShare) {
  DriveConfig drive = hundred_stands();
  drive.stands = 1000;
  drive.kidnap_share = 0.3;
  const auto stands = make_drive(bush(2), drive, 3);
  ASSERT_TRUE(stands.has_value());
  int jumps = 0;
  for (std::size_t i = 1; i < stands->size(); ++i) {
    const core::Point2 step = (*stands)[i].pose.translation() - (*stands)[i - 1].pose.translation();
    jumps += std::abs(step.norm() - 5.0) > 1e-9 ? 1 : 0;
  }
  EXPECT_NEAR(jumps, 300, 60);
}

TEST(Drive, GivenStandsAreTakenInOrderAndCheckedForObstacles) {
  WorldConfig config;
  config.stems = {{5.0, 5.0}};
  config.stands = {{{1.0, 2.0, 0.5}}, {{3.0, 4.0, -0.5}}};
  const auto stands = make_drive(*World::create(config), DriveConfig{}, 1);
  ASSERT_TRUE(stands.has_value());
  ASSERT_EQ(stands->size(), 2U);
  EXPECT_EQ((*stands)[1].pose.x_m, 3.0);
  EXPECT_EQ((*stands)[1].time_s, 300.0);
  config.stands.push_back({{5.0, 5.0, 0.0}});
  const auto refused = make_drive(*World::create(config), DriveConfig{}, 1);
  ASSERT_FALSE(refused.has_value());
  EXPECT_NE(refused.error().message.find("stand 3"), std::string::npos);
}

TEST(Drive, FullWorldIsRefusedNotSearchedForEver) {
  WorldConfig config;
  config.area = {0.0, 10.0, 0.0, 10.0, 0.0};
  EXPECT_FALSE(
      make_drive(*World::create(config), DriveConfig{}, 1).has_value());  // the margin leaves nothing
  DriveConfig drive;
  drive.step_m = 0.0;
  EXPECT_FALSE(make_drive(bush(1), drive, 1).has_value());
}

}  // namespace
}  // namespace slamsensor::tools
