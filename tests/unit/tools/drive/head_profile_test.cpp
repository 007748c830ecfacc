// The configurations for the emulated heads fit the scenarios of the same name.

#include "firmware/config/load_config.hpp"
#include "firmware/scan/scan_plan.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/drive/byte_drive.hpp"
#include "tools/emulator/scenario.hpp"

#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

const std::filesystem::path kConfigDir = tests::source_tree() / "config";

firmware::Config profile(const std::string& file) {
  const auto loaded = firmware::load_config(kConfigDir / file);
  EXPECT_TRUE(loaded) << firmware::error_lines(loaded.error());
  return loaded ? loaded->config : firmware::Config{};
}

firmware::HeadConfig emulated(const std::string& scenario_file) {
  const auto scenario = load_scenario(kConfigDir / "scenarios" / scenario_file);
  EXPECT_TRUE(scenario) << scenario.error().message;
  return head_config(scenario->head);
}

TEST(EmulatedHeadProfile, OfThePaperFitsItsScenario) {
  const firmware::HeadConfig written = profile("head-emulated-paper.toml").head;
  const firmware::HeadConfig needed = emulated("paper.toml");
  EXPECT_EQ(written.pan_tilt, needed.pan_tilt);
  EXPECT_EQ(written.rangefinder, needed.rangefinder);
  EXPECT_EQ(written.point_laser_preset, needed.point_laser_preset);
  EXPECT_EQ(written.point_laser.product, needed.point_laser.product);
  EXPECT_EQ(written.point_laser.baud, needed.point_laser.baud);
  EXPECT_EQ(written.point_laser.rate_hz, needed.point_laser.rate_hz);
}

TEST(EmulatedHeadProfile, OfTheFastHeadFitsItsScenario) {
  const firmware::Config config = profile("head-emulated-fast.toml");
  const firmware::HeadConfig needed = emulated("fast.toml");
  EXPECT_EQ(config.head.pan_tilt, needed.pan_tilt);
  EXPECT_EQ(config.head.rangefinder, needed.rangefinder);
  EXPECT_EQ(config.head.lwnx.baud, needed.lwnx.baud);
  EXPECT_EQ(config.head.lwnx.mode, needed.lwnx.mode);

  hal::PanTiltInfo unit;
  for (hal::AxisInfo* const axis : {&unit.pan, &unit.tilt}) {
    axis->resolution_rad = 23.142857 / 3600.0 * core::kDegree;
    axis->min_rad = -170.0 * core::kDegree;
    axis->max_rad = 170.0 * core::kDegree;
    axis->speed_max_radps = 300.0 * core::kDegree;
    axis->dynamics.base_speed_radps = 300.0 * core::kDegree;
  }
  const auto plan = firmware::plan_scan(config.scan_head.scan, unit, 20'000.0);
  ASSERT_TRUE(plan) << firmware::to_text(plan.error());
  EXPECT_EQ(plan->lines, 17U);
  EXPECT_LT(plan->sweep_s * plan->lines, 15.0);
}

TEST(HeadConfigOfAProfile, ChoosesTheDriverOfEachDevice) {
  HeadProfile devices;
  devices.ptu.unit = PanTiltModel::CanOpen;
  devices.rangefinder.unit = RangefinderModel::Tf03Can;
  devices.rangefinder.rate_hz = 500.0;
  const firmware::HeadConfig on_bus = head_config(devices);
  EXPECT_EQ(on_bus.pan_tilt, firmware::PanTiltKind::Canopen);
  EXPECT_EQ(on_bus.canopen.pan.scale, hal::CanopenScale::FromDrive);
  EXPECT_EQ(on_bus.rangefinder, firmware::RangefinderKind::BenewakeCan);
  EXPECT_EQ(on_bus.benewake_serial.device.rate_hz, 500.0);

  devices.rangefinder.unit = RangefinderModel::Lds70a;
  EXPECT_EQ(head_config(devices).rangefinder, firmware::RangefinderKind::PointLaser);
  EXPECT_EQ(head_config(devices).point_laser.product, hal::astech_lds70a().product);
}

}  // namespace
}  // namespace slamsensor::tools
