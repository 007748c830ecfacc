#include "tests/support/source_tree.hpp"
#include "tools/world/world.hpp"
#include "tools/world/world_config.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

namespace slamsensor::tools {
namespace {

std::string error_of(std::string_view toml) {
  const auto config = parse_world(toml, "w.toml", "");
  return config ? "" : config.error().message;
}

TEST(WorldLoader, ReadsWhatIsNamedAndKeepsTheOtherDefaults) {
  const auto config = parse_world(
      "seed = 9\n[area]\nx_min_m = -10\n[trees]\nradius_min_m = 0.15\nradius_max_m = "
      "0.2\n[rows]\nheading_deg = 90\n"
      "[[wall]]\nx2_m = 5.5\n[[mover]]\nkind = \"car\"\nspeed_mps = -3\n[[stand]]\nx_m = 2\nheading_deg = "
      "180\n",
      "w.toml", "");
  ASSERT_TRUE(config.has_value()) << config.error().message;
  EXPECT_EQ(config->seed, 9U);
  EXPECT_EQ(config->area.x_min_m, -10.0);
  EXPECT_EQ(config->area.x_max_m, AreaConfig{}.x_max_m);
  EXPECT_EQ(config->trees.radius_m.max, 0.2);
  EXPECT_NEAR(config->rows.heading_rad, 0.5 * std::numbers::pi, 1e-15);
  ASSERT_EQ(config->walls.size(), 1U);
  EXPECT_EQ(config->walls[0].x2_m, 5.5);
  ASSERT_EQ(config->movers.size(), 1U);
  EXPECT_EQ(config->movers[0].kind, MoverKind::Car);
  EXPECT_NEAR(config->stands.at(0).pose_W.heading_rad, std::numbers::pi, 1e-15);
}

TEST(WorldLoader, UnknownKeyIsNamedWithLineAndColumn) {
  EXPECT_EQ(error_of("seed = 1\n[trees]\n  radius_m = 1\n"),
            "w.toml:3:3: unknown key 'radius_m' in [trees]; remove it or correct its spelling");
  EXPECT_EQ(error_of("[tree]\n"), "w.toml:1:2: unknown key 'tree'; remove it or correct its spelling");
  EXPECT_NE(error_of("[[wall]]\nx3_m = 1\n").find("w.toml:2:1: unknown key 'x3_m'"), std::string::npos);
}

TEST(WorldLoader, WrongValuesAreRefusedWithTheirPlace) {
  EXPECT_EQ(error_of("[ground]\namplitude_m = 70"),
            "w.toml:2:15: ground.amplitude_m = 70 is out of range: 0 to 50");
  EXPECT_EQ(error_of("[ground]\namplitude_m = nan").substr(0, 12), "w.toml:2:15:");
  EXPECT_EQ(error_of("[ground]\namplitude_m = \"a\""), "w.toml:2:15: amplitude_m is a number");
  EXPECT_EQ(error_of("seed = 1.5"), "w.toml:1:8: seed is a whole number");
  EXPECT_EQ(error_of("[[mover]]\nkind = \"dog\""), "w.toml:2:8: kind is \"person\" or \"car\"");
  EXPECT_EQ(error_of("[rangefinder]\nsub_rays = 17").substr(0, 12), "w.toml:2:12:");
  EXPECT_EQ(error_of("trees = 3"), "w.toml:1:9: trees is a table: write [trees]");
  EXPECT_EQ(error_of("[wall]\nx1_m = 1").substr(0, 8), "w.toml:1");
  EXPECT_EQ(error_of("[trees]\nradius_min_m = 5.0").substr(0, 9), "w.toml:1:");
  EXPECT_NE(error_of("[area]\nx_min_m = 300").find("area is empty"), std::string::npos);
}

TEST(WorldLoader, BrokenTomlAndMissingFilesAreRefused) {
  EXPECT_EQ(error_of("seed = = 1").substr(0, 9), "w.toml:1:");
  const auto missing = load_world("no_such_world.toml");
  ASSERT_FALSE(missing.has_value());
  EXPECT_NE(missing.error().message.find("no_such_world.toml"), std::string::npos);
}

TEST(StemsCsv, FindsItsColumnsByName) {
  const auto plain = parse_stems("id,y,x\n1,2.5,3\n\n2,-1,4\n", "s.csv");
  ASSERT_TRUE(plain.has_value());
  ASSERT_EQ(plain->size(), 2U);
  EXPECT_EQ((*plain)[0], core::Point2(3.0, 2.5));
  const auto named = parse_stems("# cluster (0=all),x_m,y_m (local)\r\n7,1.0,2.0\r\n# end", "s.csv");
  ASSERT_TRUE(named.has_value());
  EXPECT_EQ(named->at(0), core::Point2(1.0, 2.0));
}

TEST(StemsCsv, RefusesWithTheLine) {
  EXPECT_EQ(parse_stems("a,b\n1,2", "s.csv").error().message.substr(0, 8), "s.csv:1:");
  EXPECT_EQ(parse_stems("x,y\n1,2\n3,\n", "s.csv").error().message.substr(0, 8), "s.csv:3:");
  EXPECT_EQ(parse_stems("x,y\n1,2m\n", "s.csv").error().message.substr(0, 8), "s.csv:2:");
  EXPECT_EQ(parse_stems("x,y\n1,inf\n", "s.csv").error().message.substr(0, 8), "s.csv:2:");
  EXPECT_FALSE(parse_stems("", "s.csv").has_value());
}

TEST(WorldLoader, StemsAreLookedForBesideTheWorld) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "slamsensor_world_loader";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "stems.csv") << "x_m,y_m\n1,2\n";
  std::ofstream(folder / "world.toml") << "[trees]\nstems_csv = \"stems.csv\"\n";
  const auto config = load_world(folder / "world.toml");
  ASSERT_TRUE(config.has_value()) << config.error().message;
  ASSERT_EQ(config->stems.size(), 1U);
  EXPECT_EQ(config->stems[0], core::Point2(1.0, 2.0));
  EXPECT_FALSE(parse_world("[trees]\nstems_csv = \"absent.csv\"", "w.toml", folder).has_value());
  std::filesystem::remove_all(folder);
}

TEST(WorldLoader, EveryWorldThatIsShippedLoadsAndFindsRoom) {
  const auto folder = tests::source_tree() / "config/worlds";
  int worlds = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto config = load_world(entry.path());
    ASSERT_TRUE(config.has_value()) << config.error().message;
    const auto world = World::create(*config);
    ASSERT_TRUE(world.has_value()) << world.error().message;
    EXPECT_EQ(world->unplaced(), 0U) << entry.path();
    EXPECT_GE(world->objects().size(), 100U) << entry.path();
    ++worlds;
  }
  EXPECT_GE(worlds, 3);
}

}  // namespace
}  // namespace slamsensor::tools
