#include "firmware/config/layered_config.hpp"

#include "firmware/config/list_config.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gmock/gmock.h>

namespace slamsensor::firmware {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kDatum =
    "[datum]\nlatitude_deg = 47.5\nlongitude_deg = 8.5\nheight_m = 400.0\nbearing_deg = 90.0\n";

std::vector<std::string> texts(const std::vector<ConfigChange>& changes) {
  std::vector<std::string> lines;
  for (const ConfigChange& change : changes) {
    lines.push_back(change.text());
  }
  return lines;
}

std::vector<std::string> texts(const std::vector<ConfigError>& errors) {
  std::vector<std::string> lines;
  for (const ConfigError& error : errors) {
    lines.push_back(error.text());
  }
  return lines;
}

class Layers : public testing::Test {
 protected:
  /// A configuration of "f.toml" and what else the test has written.
  LayeredConfig load(std::vector<Assignment> settings = {}) {
    auto layered = LayeredConfig::create({.file = folder.path() / "f.toml", .settings = std::move(settings)});
    EXPECT_TRUE(layered) << error_lines(layered.error());
    return std::move(layered.value());
  }
  /// A text with the test's folder left out.
  std::string short_text(std::string text) const {
    const std::string prefix = folder.path().string() + '/';
    for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix)) {
      text.erase(at, prefix.size());
    }
    return text;
  }

  tools::TempFolder folder;
};

TEST_F(Layers, LieOverEachOtherInOrder) {
  folder.write("f.toml",
               "[nmea]\nrate_hz = 2.0\ntalker = \"GN\"\nquality = \"rtk_fixed\"\n[fix]\nstale_s = 5\n");
  folder.write("f.toml.d/20-b.toml", "[nmea]\nrate_hz = 4.0\n");
  folder.write("f.toml.d/10-a.toml", "[nmea]\nrate_hz = 3.0\ntalker = \"IN\"\n");
  folder.write("f.toml.d/30-c.toml.bak", "[nmea]\nrate_hz = 9.0\n");
  LayeredConfig layered = load({{"nmea.quality", "rtk_float"}});
  const LoadedConfig& loaded = layered.current();
  EXPECT_EQ(loaded.config.daemon.nmea_rate_hz, 4.0);
  EXPECT_EQ(loaded.config.nmea.talker, "IN");
  EXPECT_EQ(loaded.config.nmea.quality, NmeaQuality::RtkFloat);
  EXPECT_EQ(loaded.config.daemon.fix.stale_s, 5.0);
  EXPECT_EQ(short_text(loaded.origin("nmea.rate_hz").short_text()), "f.toml.d/20-b.toml:2");
  EXPECT_EQ(short_text(loaded.origin("nmea.talker").short_text()), "f.toml.d/10-a.toml:3");
  EXPECT_EQ(short_text(loaded.origin("nmea.quality").short_text()), "--set");
  EXPECT_EQ(short_text(loaded.origin("fix.stale_s").short_text()), "f.toml:6");
  EXPECT_THAT(short_text(list_config(loaded)),
              testing::ContainsRegex("nmea.rate_hz +  *= 4.0 Hz +f.toml.d/20-b.toml:2\n"));

  ASSERT_TRUE(layered.set({{"nmea.rate_hz", "7"}}));
  EXPECT_EQ(layered.current().config.daemon.nmea_rate_hz, 7.0);
  EXPECT_EQ(layered.current().origin("nmea.rate_hz").short_text(), "control socket");
}

TEST_F(Layers, ReportTheMistakesOfAllAtOnce) {
  folder.write("f.toml", "[nmea]\nrate_hz = 99.0\n");
  folder.write("f.toml.d/a.toml", "[nmea\n");
  folder.write("f.toml.d/b.toml", "[fix]\nstale_s = 0\n[scan]\npan_min_deg = 10.0\n");
  const auto refused = LayeredConfig::create({.file = folder.path() / "f.toml",
                                              .settings = {{"nmea.landmark_sigma_m", "fine"},
                                                           {"scan.pan_max_deg", "-10"},
                                                           {"nmea.rate", "3"},
                                                           {"map.autosave_s", "]["}},
                                              .mistakes = {{{"--set", 0, 0}, "x", "was wrong before"}}});
  ASSERT_FALSE(refused);
  std::vector<std::string> lines = texts(refused.error());
  for (std::string& line : lines) {
    line = short_text(line);
  }
  EXPECT_THAT(
      lines,
      ElementsAre(HasSubstr("f.toml:2:11: nmea.rate_hz: value 99.0 is out of range"),
                  HasSubstr("f.toml.d/a.toml:1:"), HasSubstr("f.toml.d/b.toml:2:11: fix.stale_s: value 0"),
                  "--set: x: was wrong before", HasSubstr("--set: map.autosave_s: value ][ is not TOML: "),
                  HasSubstr("--set: nmea.landmark_sigma_m: value \"fine\" is not a number"),
                  HasSubstr("--set: nmea.rate: unknown key; did you mean nmea.rate_hz?"),
                  HasSubstr("f.toml.d/b.toml:4:15: scan.pan_min_deg: value 10.0 is not below "
                            "scan.pan_max_deg = -10.0 (--set)")));
}

TEST_F(Layers, ReloadAppliesWhatIsLiveAndSaysWhatIsNot) {
  folder.write("f.toml", "[nmea]\nrate_hz = 1.0\n");
  LayeredConfig layered = load();
  folder.write("f.toml", "[nmea]\nrate_hz = 5.0\nserial_baud = 9600\n[capacities]\nmap_landmarks = 5000\n");
  const auto result = layered.reload();
  ASSERT_TRUE(result) << error_lines(result.error());
  EXPECT_THAT(texts(result->live),
              ElementsAre("nmea.rate_hz 1.0 -> 5.0 (" + (folder.path() / "f.toml").string() + ":2)"));
  EXPECT_THAT(texts(result->pending),
              ElementsAre(testing::AllOf(HasSubstr("capacities.map_landmarks 10000 -> 5000 ("),
                                         HasSubstr("f.toml:5): needs a restart")),
                          HasSubstr("nmea.serial_baud 38400 -> 9600 (")));
  EXPECT_EQ(layered.current().config.daemon.nmea_rate_hz, 5.0);
  EXPECT_EQ(layered.current().config.daemon.nmea_serial.baud, 38'400U);
  EXPECT_TRUE(layered.current().origin("nmea.serial_baud").is_default());
  EXPECT_EQ(layered.pending().size(), 2U);

  const auto again = layered.reload();
  ASSERT_TRUE(again);
  EXPECT_THAT(again->live, IsEmpty());
  EXPECT_EQ(again->pending.size(), 2U);
}

TEST_F(Layers, ReloadWithAMistakeChangesNothing) {
  folder.write("f.toml", "[nmea]\nrate_hz = 2.0\n");
  LayeredConfig layered = load();
  folder.write("f.toml", "[nmea]\nrate_hz = 3.0\ntalker = \"XY\"\n");
  const auto result = layered.reload();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().size(), 1U);
  EXPECT_EQ(layered.current().config.daemon.nmea_rate_hz, 2.0);
  ASSERT_TRUE(layered.set({{"fix.stale_s", "30"}}));
  EXPECT_EQ(layered.current().config.daemon.nmea_rate_hz, 2.0) << "a refused file came in by the back door";
}

TEST_F(Layers, RuntimeKeysOutliveAReloadUntilTheyAreUnset) {
  folder.write("f.toml", "[nmea]\nrate_hz = 2.0\n");
  LayeredConfig layered = load();
  ASSERT_TRUE(layered.set({{"nmea.rate_hz", "6"}, {"nmea.sentences", "RMC, GGA"}}));
  folder.write("f.toml", "[nmea]\nrate_hz = 3.0\ntalker = \"IN\"\n");
  ASSERT_TRUE(layered.reload());
  EXPECT_EQ(layered.current().config.daemon.nmea_rate_hz, 6.0);
  EXPECT_EQ(layered.current().config.nmea.talker, "IN");
  EXPECT_TRUE(layered.current().config.nmea.sentences.gga);
  EXPECT_FALSE(layered.current().config.nmea.sentences.gbs);
  EXPECT_THAT(layered.runtime(),
              ElementsAre(Assignment{"nmea.rate_hz", "6"}, Assignment{"nmea.sentences", "RMC, GGA"}));

  const auto result = layered.unset("nmea.rate_hz");
  ASSERT_TRUE(result);
  EXPECT_THAT(texts(result->live), ElementsAre(HasSubstr("nmea.rate_hz 6.0 -> 3.0 (")));
  const auto none = layered.unset("nmea.rate_hz");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error()[0].text(),
              "control socket: nmea.rate_hz: has not been set here; nothing to take back");
}

TEST_F(Layers, SetIsAllOrNothing) {
  folder.write("f.toml", "");
  LayeredConfig layered = load();
  const auto refused = layered.set({{"nmea.rate_hz", "4"}, {"nmea.talker", "ZZ"}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(texts(refused.error()),
              ElementsAre(HasSubstr("control socket: nmea.talker: value \"ZZ\" is not one of the names")));
  EXPECT_EQ(layered.current().config.daemon.nmea_rate_hz, 1.0);
  EXPECT_THAT(layered.runtime(), IsEmpty());
}

TEST_F(Layers, AKeyThatNeedsARestartCannotBeSetInMemory) {
  folder.write("f.toml", "");
  LayeredConfig layered = load();
  const auto refused = layered.set({{"realtime.mode", "off"}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(
      texts(refused.error()),
      ElementsAre("control socket: realtime.mode: needs a restart; write it into the file and restart"));
}

TEST_F(Layers, TheDatumComesAndGoes) {
  folder.write("f.toml", kDatum);
  LayeredConfig layered = load();
  ASSERT_TRUE(layered.current().config.datum);
  ASSERT_TRUE(layered.set_absent("datum"));
  EXPECT_FALSE(layered.current().config.datum);
  ASSERT_TRUE(layered.reload());
  EXPECT_FALSE(layered.current().config.datum) << "the file brought it back";
  const auto part = layered.set({{"datum.height_m", "12"}});
  ASSERT_TRUE(part) << "the file's keys count again: " << error_lines(part.error());
  EXPECT_EQ(layered.current().config.datum->height_m, 12.0);

  folder.write("f.toml", "");
  EXPECT_FALSE(layered.reload()) << "one key alone is no datum";
  ASSERT_TRUE(layered.unset("datum.height_m"));
  const auto gone = layered.reload();
  ASSERT_TRUE(gone) << error_lines(gone.error());
  EXPECT_FALSE(layered.current().config.datum);
  EXPECT_THAT(texts(gone->live), testing::Contains(HasSubstr("datum.height_m 400.0 -> none (default)")));

  EXPECT_FALSE(layered.set({{"datum.height_m", "12"}}));
  ASSERT_TRUE(layered.set({{"datum.height_m", "12"},
                           {"datum.latitude_deg", "1"},
                           {"datum.longitude_deg", "2"},
                           {"datum.bearing_deg", "3"}}));
  EXPECT_EQ(layered.current().config.datum->longitude_deg, 2.0);
  EXPECT_FALSE(layered.set_absent("nmea"));
  EXPECT_FALSE(layered.set_absent("pan_tilt_rs485"));
}

TEST_F(Layers, ALiveKeyThatDoesNotGoWithOneInForceIsRefused) {
  folder.write("f.toml", "[nmea]\nserial_path = \"/dev/ttyS1\"\nserial_baud = 4800\nsentences = [\"RMC\"]\n");
  LayeredConfig layered = load();
  folder.write(
      "f.toml",
      "[nmea]\nserial_path = \"/dev/ttyS1\"\nserial_baud = 115200\nsentences = [\"RMC\"]\nrate_hz = 10\n");
  const auto refused = layered.reload();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error()[0].text(),
              testing::AllOf(HasSubstr("nmea.rate_hz: value 10.0 needs up to 8200.0 bits per second"),
                             HasSubstr("nmea.serial_baud = 4800"), HasSubstr("restart for both")));
  EXPECT_EQ(layered.current().config.daemon.nmea_rate_hz, 1.0);
}

TEST_F(Layers, TooManyDropInsAndOnesThatCannotBeReadAreMistakes) {
  folder.write("f.toml", "");
  for (int i = 0; i < 101; ++i) {
    folder.write("f.toml.d/" + std::to_string(i) + ".toml", "");
  }
  auto refused = load_config(folder.path() / "f.toml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error()[0].text(), HasSubstr("f.toml.d: has 101 files *.toml; at most 100 are read"));

  folder.write("g.toml", "");
  folder.write("g.toml.d", "");
  refused = load_config(folder.path() / "g.toml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error()[0].text(),
              HasSubstr("g.toml.d: the drop-in folder cannot be read: Not a directory"));
}

/// Who may use the socket must not name files for the daemon to write.
TEST_F(Layers, NoKeyThatIsAPathCanBeSetOverTheSocket) {
  folder.write("f.toml", "");
  LayeredConfig layered = load();
  std::size_t paths = 0;
  for (const Setting& setting : settings()) {
    if (allowed_text(setting).find("path") == std::string::npos) {
      continue;
    }
    ++paths;
    EXPECT_EQ(setting.apply, Apply::Restart) << setting.path;
    const auto result = layered.set({{std::string(setting.path), "/tmp/x"}});
    ASSERT_FALSE(result) << setting.path;
    EXPECT_THAT(texts(result.error()), testing::Contains(HasSubstr("needs a restart"))) << setting.path;
  }
  EXPECT_GE(paths, 6U);
}

}  // namespace
}  // namespace slamsensor::firmware
