#include "firmware/config/list_config.hpp"
#include "firmware/config/load_config.hpp"
#include "firmware/config/setting.hpp"
#include "firmware/device/head_drivers.hpp"
#include "tests/support/source_tree.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace slamsensor::firmware {

/// Converts to anything, to count how many members a struct can be initialised from. Not in the unnamed
/// namespace: clang warns of conversions there that are only looked at.
struct Anything {
  template <typename T>
  operator T() const {  // NOLINT(google-explicit-constructor): that is the point
    return T();
  }
};

namespace {

template <typename T, typename... Members>
constexpr std::size_t member_count() {
  if constexpr (requires { T{Members{}..., Anything{}}; }) {
    return member_count<T, Members..., Anything>();
  } else {
    return sizeof...(Members);
  }
}

std::size_t settings_in(std::string_view section) {
  std::size_t count = 0;
  for (const Setting& setting : settings()) {
    count += setting.section() == section ? 1U : 0U;
  }
  return count;
}

std::filesystem::path profile(const std::string& name) {
  return tests::source_tree() / "config" / name;
}

LoadedConfig loaded_profile(const std::string& name) {
  const auto loaded = load_config(profile(name));
  EXPECT_TRUE(loaded) << (loaded ? "" : error_lines(loaded.error()));
  return loaded.value_or(LoadedConfig{});
}

/// A struct of settings, and the section that has a key for each of its members but for the constants: those
/// that no user of a head and no experiment of the paper turns.
struct Counted {
  std::string_view section;
  std::size_t members;
  std::size_t constants = 0;
};

// Less those members that are structs of their own, and those that other settings decide.
const Counted kCounted[] = {
    {"mount", member_count<core::MountConfig>()},
    {"detection", member_count<core::DetectionConfig>()},
    {"association", member_count<core::AssociationConfig>(), 2},
    {"acceptance", member_count<core::AcceptanceConfig>(), 2},
    {"mapping", member_count<core::MappingConfig>(), 1},
    {"capacities", member_count<core::Capacities>()},
    {"point_cloud", member_count<PointCloudConfig>()},
    {"landmark_list", member_count<LandmarkListConfig>()},
    {"datum", member_count<Datum>()},
    // The flag of ZDA is one of the sentences.
    {"nmea",
     member_count<NmeaConfig>() - 1 + 1 + member_count<NmeaSerialConfig>() + member_count<NmeaTcpConfig>(),
     1},
    {"fix", member_count<FixConfig>()},
    {"lcm", member_count<LcmConfig>(), 1},
    {"realtime", member_count<RealtimeConfig>(), 3},
    {"map", member_count<MapStoreConfig>()},
    {"control", member_count<ControlConfig>()},
    {"record", member_count<RecordConfig>()},
    {"gpio", 2 * member_count<GpioInputSetting>() + 2 * member_count<GpioOutputSetting>() + 1, 2},
    {"head", 3},
    // The driver sets the line rate.
    {"pan_tilt_port",
     member_count<hal::SerialConfig>() - 3 + member_count<hal::SerialFormat>() +
         member_count<hal::ReopenConfig>(),
     6},
    {"rangefinder_port",
     member_count<hal::SerialConfig>() - 3 + member_count<hal::SerialFormat>() +
         member_count<hal::ReopenConfig>(),
     3},
    {"pan_tilt_rs485", member_count<hal::Rs485Config>(), 1},
    {"rangefinder_rs485", member_count<hal::Rs485Config>(), 1},
    {"ptu", member_count<hal::PtuConfig>(), 10},
    {"canopen", member_count<hal::CanopenConfig>() - 2, 12},
    {"canopen_pan", member_count<hal::CanopenAxisConfig>()},
    {"canopen_tilt", member_count<hal::CanopenAxisConfig>()},
    {"lwnx",
     member_count<hal::LwnxConfig>() - 1 + member_count<hal::RangeConfig>() - 1 +
         member_count<hal::SampleClockConfig>(),
     6},
    {"benewake",
     member_count<hal::BenewakeConfig>() - 1 + member_count<hal::RangeConfig>() - 1 +
         member_count<hal::SampleClockConfig>(),
     6},
    {"benewake_serial", member_count<hal::BenewakeSerialConfig>() - 1},
    {"benewake_can", member_count<hal::BenewakeCanConfig>() - 1},
    // And the preset.
    {"point_laser",
     member_count<hal::PointLaserConfig>() - 1 + 1 + member_count<hal::RangeConfig>() - 1 +
         member_count<hal::SampleClockConfig>(),
     6},
    // The place where names of accelerometers are looked for is none.
    {"inclination",
     member_count<LevellingConfig>() + 2 + member_count<hal::Cia410Config>() +
         member_count<hal::IioConfig>() - 1,
     2},
    {"scan", member_count<ScanConfig>(), 6},
    {"latency", member_count<LatencyConfig>(), 8},
    {"motion", member_count<MotionConfig>(), 7},
};

TEST(Settings, EveryMemberOfEveryConfigStructHasARow) {
  for (const Counted& counted : kCounted) {
    EXPECT_EQ(settings_in(counted.section) + counted.constants, counted.members) << counted.section;
  }
  EXPECT_EQ(sections().size(), std::size(kCounted));
  // No member of the larger structs was forgotten above.
  EXPECT_EQ(member_count<Config>(), 8U);
  EXPECT_EQ(member_count<core::Config>(), 6U);
  EXPECT_EQ(member_count<DaemonConfig>(), 10U);
  EXPECT_EQ(member_count<SensorHeadConfig>(), 5U);
  EXPECT_EQ(member_count<HeadConfig>(), 14U);
}

TEST(Settings, PathsAreUniqueDescribedAndOfAKnownSection) {
  std::set<std::string_view> paths;
  for (const Setting& setting : settings()) {
    EXPECT_TRUE(paths.insert(setting.path).second) << setting.path;
    EXPECT_NE(find_section(setting.section()), nullptr) << setting.path;
    EXPECT_FALSE(setting.description.empty()) << setting.path;
    const bool is_angle = setting.path.ends_with("_deg");
    EXPECT_EQ(is_angle, setting.unit == "deg") << setting.path;
    EXPECT_EQ(setting.path.ends_with("_m"), setting.unit == "m") << setting.path;
  }
}

TEST(Settings, ARetiredKeyIsNoSettingAndARetiredValueIsRefused) {
  for (const std::string_view retired : retired_settings()) {
    const std::string_view key = retired.substr(0, retired.find(' '));
    EXPECT_EQ(find_setting(key).has_value(), key != retired) << retired;
    LoadedConfig loaded;
    const std::string line = key == retired ? std::string(retired) + " = 1\n" : std::string(retired) + '\n';
    for (const ConfigError& error : apply_layer(loaded, line, "f.toml")) {
      EXPECT_NE(error.key, key) << error.text();  // others of an optional section may be missing
    }
    EXPECT_EQ(loaded.warnings.size(), 1U) << retired;
  }
  EXPECT_TRUE(is_retired("ptu.drain_s"));
  EXPECT_FALSE(is_retired("ptu.drain"));
  EXPECT_FALSE(is_retired_section("pan"));
}

TEST(Settings, EveryDefaultPassesItsOwnRange) {
  const auto loaded = load_config_text(default_config_text(), "generated");
  ASSERT_TRUE(loaded) << error_lines(loaded.error());
}

TEST(Settings, DefaultFileIsGeneratedFromTheTable) {
  std::ifstream stream(profile("slamsensor.toml"));
  std::ostringstream text;
  text << stream.rdbuf();
  EXPECT_EQ(text.str(), default_config_text()) << "config/slamsensor.toml is not what the table generates";
}

TEST(Settings, DefaultFileGivesTheVeryDefaults) {
  const LoadedConfig loaded = loaded_profile("slamsensor.toml");
  const Config defaults;
  for (const Setting& setting : settings()) {
    EXPECT_EQ(value_text(setting, loaded.config), value_text(setting, defaults)) << setting.path;
    const bool optional = find_section(setting.section())->is_optional();
    EXPECT_EQ(loaded.origin(setting.path).is_default(), optional) << setting.path;
  }
  EXPECT_EQ(loaded.config.core.detection.bearing_step_rad, defaults.core.detection.bearing_step_rad);
  EXPECT_EQ(loaded.config.core.detection.tilt_min_rad, defaults.core.detection.tilt_min_rad);
  EXPECT_FALSE(loaded.config.datum.has_value());
}

TEST(Settings, RealsAreWrittenShortAndReadBackTheSame) {
  EXPECT_EQ(real_text(300.0), "300.0");
  EXPECT_EQ(real_text(0.514), "0.514");
  EXPECT_EQ(real_text(1e-12), "1e-12");
  EXPECT_EQ(real_text(-0.1), "-0.1");
  EXPECT_EQ(real_text(0.0), "0.0");
  EXPECT_EQ(std::stod(real_text(0.1 + 0.2)), 0.1 + 0.2);
}

struct Experiment {
  const char* file;
  double tolerance_m;
  std::uint32_t landmarks_max;
  double tilt_min_deg;
  double tilt_max_deg;
};

class PaperProfile : public testing::TestWithParam<Experiment> {};

TEST_P(PaperProfile, HasThePapersValuesAndBelievesNothingByChance) {
  const core::Config config = loaded_profile(GetParam().file).config.core;
  EXPECT_EQ(config.detection.range_max_m, 300.0);
  EXPECT_EQ(config.detection.range_step_m, 0.5);
  EXPECT_DOUBLE_EQ(config.detection.bearing_step_rad, 0.514 * core::kDegree);
  EXPECT_EQ(config.detection.landmarks_max, GetParam().landmarks_max);
  EXPECT_EQ(config.detection.discard_share, 0.02);
  EXPECT_EQ(config.detection.point, core::LandmarkPoint::HullCentroid);
  EXPECT_DOUBLE_EQ(config.detection.tilt_min_rad, GetParam().tilt_min_deg * core::kDegree);
  EXPECT_DOUBLE_EQ(config.detection.tilt_max_rad, GetParam().tilt_max_deg * core::kDegree);
  EXPECT_EQ(config.association.tolerance_m, GetParam().tolerance_m);
  EXPECT_EQ(config.association.order_share, 0.125);
  EXPECT_EQ(config.association.depth, 2U);
  EXPECT_TRUE(config.association.exhaust_when_unsure);
  EXPECT_EQ(config.mapping.prune_share, 0.0);
  EXPECT_EQ(config.acceptance.rule, core::AcceptanceRule::Evidence);
  EXPECT_EQ(config.mapping.hypotheses_max, 3U);
  EXPECT_EQ(config.mapping.update, core::LandmarkUpdate::Paper);
}

INSTANTIATE_TEST_SUITE_P(Paper, PaperProfile,
                         testing::Values(Experiment{"experiment-1.toml", 0.5, 30, -18.0, 7.71},
                                         Experiment{"experiment-2.toml", 1.0, 30, -18.0, 7.71},
                                         Experiment{"experiment-3.toml", 1.5, 20, -17.5, 8.23},
                                         Experiment{"experiment-4.toml", 1.5, 20, -17.5, 8.23}));

TEST(Profiles, EveryFileOfTheFolderLoads) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(profile(""))) {
    if (entry.path().extension() == ".toml") {
      loaded_profile(entry.path().filename().string());
      ++files;
    }
  }
  EXPECT_GE(files, 15);
}

struct HeadProfile {
  const char* file;
  PanTiltKind pan_tilt;
  RangefinderKind rangefinder;
};

class HeadProfiles : public testing::TestWithParam<HeadProfile> {};

TEST_P(HeadProfiles, HaveTheirDevicesAndTheirDriversAreMade) {
  const HeadConfig head = loaded_profile(GetParam().file).config.head;
  EXPECT_EQ(head.pan_tilt, GetParam().pan_tilt);
  EXPECT_EQ(head.rangefinder, GetParam().rangefinder);
  const auto links = open_head_links(head);
  ASSERT_TRUE(links) << links.error().message;
  EXPECT_TRUE(make_head_drivers(head, links->get()));
}

INSTANTIATE_TEST_SUITE_P(
    Heads, HeadProfiles,
    testing::Values(HeadProfile{"head-paper.toml", PanTiltKind::Ptu, RangefinderKind::PointLaser},
                    HeadProfile{"head-ptu-lightware.toml", PanTiltKind::Ptu, RangefinderKind::Lwnx},
                    HeadProfile{"head-ptu-tf03.toml", PanTiltKind::Ptu, RangefinderKind::BenewakeSerial},
                    HeadProfile{"head-canopen-tf03.toml", PanTiltKind::Canopen, RangefinderKind::BenewakeCan},
                    HeadProfile{"head-emulated-paper.toml", PanTiltKind::Ptu, RangefinderKind::PointLaser},
                    HeadProfile{"head-emulated-fast.toml", PanTiltKind::Ptu, RangefinderKind::Lwnx}));

TEST(Suggestions, CountEditsAndNameTheNearest) {
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("rnage", "range"), 1U);
  EXPECT_EQ(suggest_section("detecton"), "detection");
  EXPECT_EQ(suggest_section("weather_forecast"), "");
  EXPECT_EQ(suggest_key("detection.tilt_min"), "detection.tilt_min_deg");
  EXPECT_EQ(suggest_key("detection.tolerance_m"), "association.tolerance_m");
  EXPECT_EQ(suggest_key("detection.colour_of_paint"), "");
  EXPECT_EQ(suggest_section("NMEA"), "nmea");
  EXPECT_EQ(suggest_key("nmea.Rate_Hz"), "nmea.rate_hz");
  EXPECT_EQ(suggest_key("fix.rate_hz"),
            "lwnx.rate_hz, benewake.rate_hz, point_laser.rate_hz or nmea.rate_hz");
  EXPECT_EQ(suggest_key("detection." + std::string(5000, 'x')), "");
}

}  // namespace
}  // namespace slamsensor::firmware
