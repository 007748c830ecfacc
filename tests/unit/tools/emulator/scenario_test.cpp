#include "tools/emulator/scenario.hpp"

#include "tests/support/source_tree.hpp"
#include "tests/unit/tools/emulator/small_devices.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

namespace slamsensor::tools {
namespace {

class ScenarioFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("scenario_test_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)));
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "w.toml") << "seed = 5\n[trees]\ndensity_per_ha = 10.0\n";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] tl::expected<Scenario, WorldError> parse(const std::string& text) const {
    return parse_scenario("world = \"w.toml\"\n" + text, "s.toml", folder_);
  }
  [[nodiscard]] std::string error_of(const std::string& text) const {
    const auto scenario = parse(text);
    return scenario ? "" : scenario.error().message;
  }

  std::filesystem::path folder_;
};

TEST_F(ScenarioFile, AWorldAloneIsADriveThroughIt) {
  const auto scenario = parse_scenario("seed = 9\n", "w.toml", "", HeadKind::Fast);
  ASSERT_TRUE(scenario.has_value()) << scenario.error().message;
  EXPECT_EQ(scenario->world.seed, 9U);
  EXPECT_EQ(scenario->head.rangefinder.rate_hz, 20'000.0);
  const auto file = load_scenario(folder_ / "w.toml");
  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(file->world.seed, 5U);
  EXPECT_EQ(file->head.ptu.baud, 9600U);
}

TEST_F(ScenarioFile, ReadsEveryTable) {
  const auto scenario = parse(
      "head = \"fast\"\nseed = 3\nworld_seed = 77\n"
      "[mount]\nheight_m = 2.0\nroll_deg = 1.0\n"
      "[ptu]\nunit = \"d46-17.5\"\nbaud = 38400\nreply_latency_ms = 20\nbegin = \"ready\"\n"
      "[rangefinder]\nunit = \"tf03\"\nrate_hz = 1000\nlatency_ms = 5\nusb_ms = 16\n"
      "[stands]\nchange = \"on_scan_end\"\ndwell_s = 20\n"
      "[drive]\nstands = 7\nstep_m = 2.5\n"
      "[[kidnap]]\nat_s = 60\nx_m = 3\ny_m = 4\nheading_deg = 90\n"
      "[[fault]]\ndevice = \"ptu\"\nkind = \"power_cycle\"\nat_s = 12.5\nduration_s = 2\n"
      "[[fault_rate]]\ndevice = \"rangefinder\"\nkind = \"bad_checksum\"\nrhythm = \"regular\"\nmean_gap_s = "
      "9\n");
  ASSERT_TRUE(scenario.has_value()) << scenario.error().message;
  EXPECT_EQ(scenario->seed, 3U);
  EXPECT_EQ(scenario->world.seed, 77U);
  EXPECT_EQ(scenario->mount.mount_height_m, 2.0);
  EXPECT_EQ(scenario->head.ptu.unit, PanTiltModel::D46_17_5);
  EXPECT_EQ(scenario->head.ptu.baud, 38400U);
  EXPECT_DOUBLE_EQ(scenario->head.ptu.reply_latency_s, 0.020);
  EXPECT_EQ(scenario->head.ptu.begin, DeviceBegin::Ready);
  EXPECT_EQ(scenario->head.ptu.reset_s, 2.0);  // of the fast head
  EXPECT_EQ(scenario->head.rangefinder.unit, RangefinderModel::Tf03);
  EXPECT_DOUBLE_EQ(scenario->head.rangefinder.usb_s, 0.016);
  EXPECT_EQ(scenario->change, StandChange::OnScanEnd);
  EXPECT_EQ(scenario->drive.period_s, 20.0);
  EXPECT_EQ(scenario->drive.stands, 7U);
  ASSERT_EQ(scenario->kidnaps.size(), 1U);
  EXPECT_NEAR(scenario->kidnaps[0].pose_W.heading_rad, 0.5 * std::numbers::pi, 1e-15);
  ASSERT_EQ(scenario->faults.size(), 1U);
  EXPECT_EQ(scenario->faults[0].kind, FaultKind::PowerCycle);
  ASSERT_EQ(scenario->rates.size(), 1U);
  EXPECT_EQ(scenario->rates[0].rhythm, FaultRhythm::Regular);
}

TEST_F(ScenarioFile, APathIsStandsAlongIt) {
  const auto scenario = parse(
      "[stands]\npath_step_m = 4\n"
      "[[waypoint]]\nx_m = 0\ny_m = 0\n[[waypoint]]\nx_m = 10\ny_m = 0\n[[waypoint]]\nx_m = 10\ny_m = 7\n");
  ASSERT_TRUE(scenario.has_value()) << scenario.error().message;
  const auto& stands = scenario->world.stands;
  ASSERT_EQ(stands.size(), 5U);  // 0, 4, 8 m on the first leg; 2 and 6 m on the second
  EXPECT_DOUBLE_EQ(stands[2].pose_W.x_m, 8.0);
  EXPECT_DOUBLE_EQ(stands[3].pose_W.x_m, 10.0);
  EXPECT_DOUBLE_EQ(stands[3].pose_W.y_m, 2.0);
  EXPECT_DOUBLE_EQ(stands[3].pose_W.heading_rad, 0.5 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(stands[4].pose_W.y_m, 6.0);
}

TEST_F(ScenarioFile, EveryMistakeHasItsPlace) {
  EXPECT_EQ(error_of("[ptu]\nbaud = 5\n"), "s.toml:3:8: ptu.baud = 5 is out of range: 600 to 4e+06");
  EXPECT_EQ(error_of("[ptu]\nbuad = 9600\n"),
            "s.toml:3:1: unknown key 'buad' in [ptu]; remove it or correct its spelling");
  EXPECT_EQ(error_of("heads = 1\n"), "s.toml:2:1: unknown key 'heads'; remove it or correct its spelling");
  EXPECT_EQ(error_of("head = \"slow\"\n"), "s.toml:2:8: head is \"paper\" or \"fast\"");
  EXPECT_EQ(error_of("seed = -1\n").substr(0, 12), "s.toml:2:8: ");
  EXPECT_EQ(error_of("[[kidnap]]\nat_s = 1\nx_m = 0\n"), "s.toml:2:1: [kidnap] needs the key 'y_m'");
  EXPECT_EQ(error_of("[[fault]]\ndevice = \"ptu\"\nat_s = 1\n"), "s.toml:2:1: [fault] needs the key 'kind'");
  EXPECT_EQ(error_of("[[fault]]\ndevice = \"ptu\"\nkind = \"weak_signal\"\nat_s = 1\n"),
            "s.toml:2:1: [fault] kind = \"weak_signal\" is no fault of this ptu");
  EXPECT_EQ(error_of("[[fault]]\ndevice = \"gps\"\nkind = \"noise\"\nat_s = 1\n"),
            "s.toml:3:10: device is \"ptu\", \"rangefinder\" or \"can\"");
  EXPECT_EQ(error_of("[[fault]]\ndevice = \"can\"\nkind = \"bus_off\"\nat_s = 1\n"),
            "s.toml:2:1: [fault] device = \"can\": this head has no device on a CAN bus");
  EXPECT_EQ(error_of("[[fault]]\ndevice = \"ptu\"\nkind = \"noise\"\nat_s = 1\n[ptu]\nunit = \"canopen\"\n"),
            "s.toml:2:1: [fault] kind = \"noise\" needs a serial line, and the ptu is on a CAN bus");
  EXPECT_EQ(error_of("[[waypoint]]\nx_m = 0\ny_m = 0\n").substr(0, 7), "s.toml:");
  EXPECT_NE(error_of("[[waypoint]]\nx_m = 0\ny_m = 0\n[[stand]]\nx_m = 0\n").find("remove one"),
            std::string::npos);
  EXPECT_EQ(error_of("[[fault]\n").substr(0, 9), "s.toml:2:");
}

TEST_F(ScenarioFile, AWorldThatCannotBeReadIsReportedWithBothFiles) {
  const auto missing = parse_scenario("seed = 1\nworld = \"none.toml\"\n", "s.toml", folder_);
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().message.substr(0, 19), "s.toml:2:9: world: ");
  EXPECT_NE(missing.error().message.find("none.toml: cannot be opened"), std::string::npos);
  std::ofstream(folder_ / "bad.toml") << "[trees]\ndensity = 3\n";
  const auto bad = parse_scenario("world = \"bad.toml\"\n", "s.toml", folder_);
  EXPECT_NE(bad.error().message.find("bad.toml:2:1: unknown key 'density'"), std::string::npos);
  const auto number = parse_scenario("world = 3\n", "s.toml", folder_);
  EXPECT_EQ(number.error().message, "s.toml:1:9: world is a text in quotes");
}

TEST_F(ScenarioFile, FaultsOfTheBusNeedAHeadOnTheBus) {
  const auto scenario = parse(
      "[rangefinder]\nunit = \"tf03-can\"\n"
      "[[fault]]\ndevice = \"can\"\nkind = \"bus_off\"\nat_s = 1\nduration_s = 0.5\n"
      "[[fault]]\ndevice = \"rangefinder\"\nkind = \"silence\"\nat_s = 1\nduration_s = 0.5\n");
  EXPECT_TRUE(scenario.has_value()) << scenario.error().message;
}

TEST(ShippedScenarios, AreValidAndTheirPlacesAreFree) {
  const auto folder = tests::source_tree() / "config/scenarios";
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto scenario = load_scenario(entry.path());
    ASSERT_TRUE(scenario.has_value()) << scenario.error().message;
    const auto head = EmulatedHead::create(*scenario, make_small_devices);
    EXPECT_TRUE(head.has_value()) << entry.path() << ": " << head.error().message;
    ++count;
  }
  EXPECT_GE(count, 3U);
}

}  // namespace
}  // namespace slamsensor::tools
