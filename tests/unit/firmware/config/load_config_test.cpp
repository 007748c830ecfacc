#include "firmware/config/load_config.hpp"

#include "firmware/config/list_config.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;

TEST(LoadConfig, StoresValuesWithUnitsAndOrigin) {
  const auto loaded = load_config_text(
      "[detection]\nrange_max_m = 80\n  tilt_min_deg = -18.0\npoint = \"reading_mean\"\n"
      "[mapping]\npropagate_corrections = true\n",
      "f.toml");
  ASSERT_TRUE(loaded) << error_lines(loaded.error());
  EXPECT_EQ(loaded->config.core.detection.range_max_m, 80.0);
  EXPECT_DOUBLE_EQ(loaded->config.core.detection.tilt_min_rad, -18.0 * core::kDegree);
  EXPECT_EQ(loaded->config.core.detection.point, core::LandmarkPoint::ReadingMean);
  EXPECT_TRUE(loaded->config.core.mapping.propagate_corrections);
  EXPECT_EQ(loaded->config.core.association.tolerance_m, 0.5);
  EXPECT_EQ(loaded->origin("detection.tilt_min_deg").file, "f.toml");
  EXPECT_EQ(loaded->origin("detection.tilt_min_deg").line, 3U);
  EXPECT_EQ(loaded->origin("detection.tilt_min_deg").column, 18U);
  EXPECT_TRUE(loaded->origin("detection.tilt_max_deg").is_default());
}

TEST(LoadConfig, TakesEveryWayOfWritingATable) {
  const auto loaded = load_config_text(
      "detection.range_max_m = 80\nassociation = {depth = 3}\ncapacities.map_edges = 200000", "f.toml");
  ASSERT_TRUE(loaded) << error_lines(loaded.error());
  EXPECT_EQ(loaded->config.core.detection.range_max_m, 80.0);
  EXPECT_EQ(loaded->config.core.association.depth, 3U);
}

TEST(LoadConfig, EmptyFileGivesTheDefaults) {
  const auto loaded = load_config_text("", "empty.toml");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->config.core.detection.landmarks_max, 0U);
  EXPECT_FALSE(loaded->config.datum);
}

TEST(LoadConfig, LaterLayersWinAndKeepTheOriginOfTheRest) {
  LoadedConfig loaded;
  EXPECT_TRUE(
      apply_layer(loaded, "[detection]\nrange_max_m = 80\nlandmarks_max = 20\n", "base.toml").empty());
  EXPECT_TRUE(apply_layer(loaded, "[detection]\nlandmarks_max = 25\n", "drop-in.toml").empty());
  EXPECT_TRUE(check_config(loaded).empty());
  EXPECT_EQ(loaded.config.core.detection.range_max_m, 80.0);
  EXPECT_EQ(loaded.config.core.detection.landmarks_max, 25U);
  EXPECT_EQ(loaded.origin("detection.range_max_m").short_text(), "base.toml:2");
  EXPECT_EQ(loaded.origin("detection.landmarks_max").short_text(), "drop-in.toml:2");
}

TEST(LoadConfig, ALayerThatBreaksARuleWithAnEarlierOneIsFound) {
  LoadedConfig loaded;
  EXPECT_TRUE(apply_layer(loaded, "[detection]\ntilt_max_deg = -10\n", "base.toml").empty());
  EXPECT_TRUE(apply_layer(loaded, "[detection]\ntilt_min_deg = 5\n", "drop-in.toml").empty());
  const std::vector<ConfigError> errors = check_config(loaded);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].text(),
            "drop-in.toml:2:16: detection.tilt_min_deg: value 5.0 is above detection.tilt_max_deg = -10.0 "
            "(base.toml:2); "
            "change one of them");
}

// The laser behind a udev name and the unit behind its /dev/ttyUSB0 were two devices.
TEST(LoadConfig, ADeviceUnderTwoNamesIsOne) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("ports." + std::to_string(::getpid()));
  std::filesystem::create_directories(folder / "sub");
  std::ofstream(folder / "tty") << "";
  std::filesystem::create_symlink("tty", folder / "laser");
  std::filesystem::create_symlink(folder / "laser", folder / "sub/unit");
  const auto clashes = [](const std::string& pan_tilt, const std::string& rangefinder,
                          const std::string& nmea) {
    LoadedConfig loaded;
    loaded.config.head.pan_tilt_port.path = pan_tilt;
    loaded.config.head.rangefinder_port.path = rangefinder;
    loaded.config.daemon.nmea_serial.path = nmea;
    const auto errors = check_config(loaded);
    return std::count_if(errors.begin(), errors.end(), [](const ConfigError& error) {
      return error.text().find("is the same as") != std::string::npos;
    });
  };
  const std::string tty = folder / "tty";
  for (const std::string& name :
       {tty, (folder / "laser").string(), (folder / "sub/unit").string(), (folder / "sub/../tty").string()}) {
    EXPECT_EQ(clashes(tty, name, ""), 1) << name;
    EXPECT_EQ(clashes(name, "/dev/other", tty), 1) << name;
    EXPECT_EQ(clashes("/dev/other", name, tty), 1) << name;
  }
  EXPECT_EQ(clashes("/dev/null", "/dev/zero", ""), 0);
  EXPECT_EQ(clashes("/dev/none", "/dev/../dev/none", ""), 1) << "not plugged in yet";
  EXPECT_EQ(clashes("/dev/none", "/dev/none2", ""), 0);
  std::filesystem::remove_all(folder);
}

TEST(LoadConfig, RoomForAScanlineIsRefusedOnlyWhereTheSettingsSayTheNeed) {
  const std::string scan = "[scan]\nreadings_per_line_max = 1000\n";
  const std::string laser = "rangefinder = \"point_laser\"\n[point_laser]\nrate_hz = 1000\n";
  const std::string narrow = "[canopen_pan]\nmin_deg = -20\nmax_deg = 20\n";
  EXPECT_TRUE(load_config_text(scan + "[head]\nrangefinder = \"lwnx\"\n", "f.toml"));
  EXPECT_FALSE(load_config_text(scan + "[head]\n" + laser, "f.toml"));
  EXPECT_FALSE(load_config_text(scan + narrow + "[head]\n" + laser, "f.toml"));
  EXPECT_TRUE(load_config_text(scan + narrow + "[head]\npan_tilt = \"canopen\"\n" + laser, "f.toml"));
}

TEST(LoadConfig, DatumIsWholeOrAbsent) {
  const auto loaded = load_config_text(
      "[datum]\nlatitude_deg = 47.5\nlongitude_deg = -8\nheight_m = 412.35\nbearing_deg = 12.5\n", "f.toml");
  ASSERT_TRUE(loaded) << error_lines(loaded.error());
  ASSERT_TRUE(loaded->config.datum);
  EXPECT_EQ(loaded->config.datum->latitude_deg, 47.5);
  EXPECT_EQ(loaded->config.datum->longitude_deg, -8.0);
  EXPECT_EQ(loaded->config.datum->height_m, 412.35);
  EXPECT_EQ(loaded->config.datum->bearing_deg, 12.5);

  LoadedConfig changed = *loaded;
  EXPECT_TRUE(apply_layer(changed, "[datum]\nheight_m = 5.0\n", "drop-in.toml").empty());
  EXPECT_EQ(changed.config.datum->height_m, 5.0);
  EXPECT_EQ(changed.config.datum->latitude_deg, 47.5);
}

TEST(LoadConfig, ReportsEveryMistakeInTheOrderOfTheLines) {
  const auto loaded = load_config_text(
      "[nmea]\ntalker = \"XX\"\n[detection]\nrange_max_m = nan\nrnage_min_m = 1\n[asociation]\ndepth = 2\n",
      "f.toml");
  ASSERT_FALSE(loaded);
  ASSERT_EQ(loaded.error().size(), 4U) << error_lines(loaded.error());
  EXPECT_THAT(loaded.error()[0].text(),
              HasSubstr("f.toml:2:10: nmea.talker: value \"XX\" is not one of the names"));
  EXPECT_THAT(loaded.error()[1].text(),
              HasSubstr("f.toml:4:15: detection.range_max_m: value nan is not a finite"));
  EXPECT_THAT(loaded.error()[2].text(),
              HasSubstr("f.toml:5:1: detection.rnage_min_m: unknown key; did you mean "
                        "detection.range_min_m?"));
  EXPECT_THAT(loaded.error()[3].text(),
              HasSubstr("f.toml:6:2: asociation: unknown section; did you mean association?"));
}

TEST(LoadConfig, KeysOfAFormerVersionAreNamedAndHaveNoEffect) {
  const auto loaded = load_config_text(
      "[pan_fit]\npolls_min = 4\n[ptu]\nwake_wait_s = \"x\"\ndrain_s = 0.1\n[nmea]\nrate_hz = 5.0\n",
      "f.toml");
  ASSERT_TRUE(loaded) << error_lines(loaded.error());
  EXPECT_EQ(error_lines(loaded->warnings),
            "f.toml:2:1: pan_fit.polls_min: has no effect any more; remove it\n"
            "f.toml:4:1: ptu.wake_wait_s: has no effect any more; remove it\n"
            "f.toml:5:1: ptu.drain_s: has no effect any more; remove it\n");
  EXPECT_EQ(loaded->config.daemon.nmea_rate_hz, 5.0);
}

TEST(LoadConfig, AValueOfAFormerVersionIsNamedAndHasNoEffect) {
  const auto loaded = load_config_text("[acceptance]\nrule = \"computed\"\n", "f.toml");
  ASSERT_TRUE(loaded) << error_lines(loaded.error());
  EXPECT_EQ(error_lines(loaded->warnings),
            "f.toml:2:8: acceptance.rule: value \"computed\" has no effect any more; remove it\n");
  EXPECT_EQ(loaded->config.core.acceptance.rule, Config{}.core.acceptance.rule);
  EXPECT_FALSE(load_config_text("[acceptance]\nrule = \"computd\"\n", "f.toml"));
}

TEST(LoadConfig, AMisspeltKeyBesideOneOfAFormerVersionIsAMistake) {
  const auto loaded =
      load_config_text("[pan_fit]\npolls_min = 4\npols_min = 4\n[ptu]\ndrain = 1\n", "f.toml");
  ASSERT_FALSE(loaded);
  ASSERT_EQ(loaded.error().size(), 2U) << error_lines(loaded.error());
  EXPECT_THAT(loaded.error()[0].text(), HasSubstr("f.toml:3:1: pan_fit.pols_min: unknown key"));
  EXPECT_THAT(loaded.error()[1].text(), HasSubstr("f.toml:5:1: ptu.drain: unknown key"));
}

TEST(LoadConfig, AMistakeIsNotReportedTwice) {
  // The refused tilt_min leaves its default in force; the rule about both must not speak of a value nobody
  // wrote.
  const auto loaded = load_config_text("[detection]\ntilt_min_deg = 95\ntilt_max_deg = -89.5\n", "f.toml");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().size(), 1U) << error_lines(loaded.error());
}

TEST(LoadConfig, StopsListingAfterAHundredMistakes) {
  std::string text = "[detection]\n";
  for (int i = 0; i < 250; ++i) {
    text += "nonsense_" + std::to_string(i) + " = 1\n";
  }
  const auto loaded = load_config_text(text, "f.toml");
  ASSERT_FALSE(loaded);
  ASSERT_EQ(loaded.error().size(), kConfigErrorsMax + 1);
  EXPECT_EQ(loaded.error().back().text(), "f.toml: 150 more mistakes; correct those above first");
}

TEST(LoadConfig, SaysWhyAFileCannotBeRead) {
  const auto absent = load_config("no-such-folder/no-such-file.toml");
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error()[0].text(),
              HasSubstr("no-such-folder/no-such-file.toml: cannot be opened: No such file"));
  const auto folder = load_config(".");
  ASSERT_FALSE(folder);
  EXPECT_THAT(folder.error()[0].text(), HasSubstr("is a folder"));
}

TEST(ListConfig, ShowsEveryKeyWithValueUnitAndOrigin) {
  const auto loaded = load_config_text("[detection]\nbearing_step_deg = 1\n", "f.toml");
  ASSERT_TRUE(loaded);
  const std::string list = list_config(*loaded);
  EXPECT_THAT(list, testing::ContainsRegex("detection.bearing_step_deg +  *= 1.0 deg +f.toml:2\n"));
  EXPECT_THAT(list, testing::ContainsRegex("detection.range_max_m +  *= 300.0 m +default\n"));
  EXPECT_THAT(list, testing::ContainsRegex("datum.latitude_deg +  *= none +default\n"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(list.begin(), list.end(), '\n')), settings().size());
}

TEST(LoadConfig, DoesNotWaitForAPipe) {
  const tools::TempFolder folder;
  const std::filesystem::path pipe = folder.path() / "f.toml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto loaded = load_config(pipe);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(error_lines(loaded.error()), HasSubstr("f.toml: is a pipe or a socket"));
  folder.write("g.toml", "");
  std::filesystem::create_directory(folder.path() / "g.toml.d");
  ASSERT_EQ(::mkfifo((folder.path() / "g.toml.d/1.toml").c_str(), 0600), 0);
  EXPECT_THAT(error_lines(load_config(folder.path() / "g.toml").error()), HasSubstr("1.toml: is a pipe"));
  EXPECT_TRUE(load_config("/dev/null"));
}

TEST(LoadConfig, TablesTooDeepForTheParserAreRefused) {
  std::string path = "a";
  for (int i = 0; i < 50'000; ++i) {
    path += i % 2 == 0 ? ".a" : " . 'a'";
  }
  for (const std::string& text :
       {"# c\n\n[" + path + "]\n", "# c\n\n[[" + path + "]]\n", "# c\n\n" + path + " = 1\n",
        "# c\n\nt = {" + path + " = 1}\n", "s = \"a # \\\"\"\nt = ''''''\n[" + path + "]",
        "s = \"never ended\n\n[" + path + "]"}) {
    const auto loaded = load_config_text(text, "f.toml");
    ASSERT_FALSE(loaded);
    EXPECT_THAT(error_lines(loaded.error()), HasSubstr("f.toml:3:1: not TOML: a key has more parts"))
        << text.substr(0, 40);
  }
  const std::string arrays = std::string(50'000, '[') + std::string(50'000, ']');
  EXPECT_FALSE(load_config_text("[x]\na = " + arrays, "f.toml"));
}

TEST(LoadConfig, DotsThatAreNoKeysAreManyAsTheyLike) {
  const std::string dots(1000, '.');
  EXPECT_EQ(too_deep_line("# " + dots + "\na = \"" + dots + "\"\nb = '''" + dots + "\n" + dots + "'''\n"),
            std::nullopt);
  std::string numbers = "a = [1.0";
  for (int i = 0; i < 1000; ++i) {
    numbers += ", 1.0";
  }
  EXPECT_EQ(too_deep_line(numbers + "]\n"), std::nullopt);
  EXPECT_EQ(too_deep_line("a = \"\"\"" + dots), std::nullopt);
  EXPECT_EQ(too_deep_line("a." + dots), 1U);
}

}  // namespace
}  // namespace slamsensor::firmware
