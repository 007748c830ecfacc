#include "firmware/device/head_drivers.hpp"

#include <gmock/gmock.h>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr hal::Stamp kStart = std::chrono::seconds(1);

/// Links of devices that are not there.
OwnedHeadLinks absent_links(HeadConfig config) {
  config.pan_tilt_port.path = "/dev/no-such-pan-tilt-unit";
  config.rangefinder_port.path = "/dev/no-such-rangefinder";
  config.can_interface = "nosuchcan0";
  auto links = open_head_links(config);
  EXPECT_TRUE(links) << links.error().message;
  return links ? std::move(*links) : OwnedHeadLinks{};
}

struct Kinds {
  PanTiltKind pan_tilt;
  RangefinderKind rangefinder;
  bool pan_tilt_on_bus;
  bool rangefinder_on_bus;
};

class HeadDriversOfKind : public testing::TestWithParam<Kinds> {};

TEST_P(HeadDriversOfKind, HaveTheLinksThatTheyNeedAndWaitForTheirDevices) {
  HeadConfig config;
  config.pan_tilt = GetParam().pan_tilt;
  config.rangefinder = GetParam().rangefinder;
  const OwnedHeadLinks links = absent_links(config);
  EXPECT_EQ(links.pan_tilt_can != nullptr, GetParam().pan_tilt_on_bus);
  EXPECT_EQ(links.pan_tilt_bytes != nullptr, !GetParam().pan_tilt_on_bus);
  EXPECT_EQ(links.rangefinder_can != nullptr, GetParam().rangefinder_on_bus);
  EXPECT_EQ(links.rangefinder_bytes != nullptr, !GetParam().rangefinder_on_bus);

  const auto drivers = make_head_drivers(config, links.get());
  ASSERT_TRUE(drivers) << drivers.error().message;
  for (int ms = 0; ms < 100; ++ms) {
    drivers->pan_tilt->step(kStart + std::chrono::milliseconds(ms));
    drivers->rangefinder->step(kStart + std::chrono::milliseconds(ms));
  }
  EXPECT_NE(drivers->pan_tilt->state(), hal::DeviceState::Ready);
  EXPECT_NE(drivers->rangefinder->state(), hal::DeviceState::Ready);
  EXPECT_THAT(std::string(drivers->pan_tilt->problem()), testing::Not(IsEmpty()));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, HeadDriversOfKind,
    testing::Values(Kinds{PanTiltKind::Ptu, RangefinderKind::Lwnx, false, false},
                    Kinds{PanTiltKind::Ptu, RangefinderKind::BenewakeSerial, false, false},
                    Kinds{PanTiltKind::Ptu, RangefinderKind::PointLaser, false, false},
                    Kinds{PanTiltKind::Ptu, RangefinderKind::BenewakeCan, false, true},
                    Kinds{PanTiltKind::Canopen, RangefinderKind::Lwnx, true, false},
                    Kinds{PanTiltKind::Canopen, RangefinderKind::BenewakeCan, true, true}));

TEST(HeadLinks, OpenAtTheRateThatTheDriverTriesFirst) {
  HeadConfig config;
  config.ptu.rates_baud = {38'400, 9600};
  config.lwnx.baud = 921'600;
  EXPECT_EQ(absent_links(config).pan_tilt_bytes->baud(), 38'400U);
  EXPECT_EQ(absent_links(config).rangefinder_bytes->baud(), 921'600U);
  config.rangefinder = RangefinderKind::PointLaser;
  config.point_laser.baud = 19'200;
  EXPECT_EQ(absent_links(config).rangefinder_bytes->baud(), 19'200U);
  config.rangefinder = RangefinderKind::BenewakeSerial;
  config.benewake_serial.baud = 57'600;
  EXPECT_EQ(absent_links(config).rangefinder_bytes->baud(), 57'600U);
}

TEST(HeadLinks, NameTheSettingThatIsWrong) {
  HeadConfig config;
  config.pan_tilt_port.path = "ttyS0";
  auto links = open_head_links(config);
  ASSERT_FALSE(links);
  EXPECT_THAT(links.error().message, testing::StartsWith("pan_tilt_port: "));

  config = {};
  config.rangefinder_port.line.format.data_bits = 9;
  links = open_head_links(config);
  ASSERT_FALSE(links);
  EXPECT_THAT(links.error().message, testing::StartsWith("rangefinder_port: "));

  config = {};
  config.pan_tilt = PanTiltKind::Canopen;
  config.can_interface = "a name that is too long";
  links = open_head_links(config);
  ASSERT_FALSE(links);
  EXPECT_THAT(links.error().message, testing::StartsWith("head.can_interface: "));
}

std::string refusal(const HeadConfig& config) {
  const OwnedHeadLinks links = absent_links(config);
  const auto drivers = make_head_drivers(config, links.get());
  return drivers ? "" : drivers.error().message;
}

TEST(HeadDrivers, NameTheSettingThatIsWrong) {
  HeadConfig config;
  config.ptu.poll_hz = 0.0;
  EXPECT_THAT(refusal(config), testing::StartsWith("ptu: pan-tilt unit: poll_hz"));

  config = {};
  config.pan_tilt = PanTiltKind::Canopen;
  config.canopen.tilt.node = config.canopen.pan.node;
  EXPECT_THAT(refusal(config), testing::StartsWith("canopen: "));

  config = {};
  config.lwnx.baud = 1000;
  EXPECT_THAT(refusal(config), testing::AllOf(testing::StartsWith("lwnx: "), HasSubstr("baud 1000")));

  config = {};
  config.rangefinder = RangefinderKind::PointLaser;
  config.point_laser.terminator = "";
  EXPECT_THAT(refusal(config), testing::StartsWith("point_laser: "));

  config = {};
  config.rangefinder = RangefinderKind::BenewakeSerial;
  config.benewake_serial.device.rate_hz = 123.0;
  EXPECT_THAT(refusal(config), testing::StartsWith("benewake: "));
}

TEST(HeadDrivers, ADeviceOnTheBusHasTheSettingsOfItsSerialTwin) {
  HeadConfig config;
  config.rangefinder = RangefinderKind::BenewakeCan;
  config.benewake_serial.device.rate_hz = 123.0;
  EXPECT_THAT(refusal(config), HasSubstr("rate_hz 123"));
  config.benewake_serial.device.rate_hz = 500.0;
  EXPECT_EQ(refusal(config), "");
}

TEST(HeadDrivers, AMissingLinkIsAnError) {
  HeadConfig config;
  EXPECT_THAT(make_head_drivers(config, {}).error().message,
              HasSubstr("head.pan_tilt: the pan-tilt unit needs a serial line"));
  config.pan_tilt = PanTiltKind::Canopen;
  EXPECT_THAT(make_head_drivers(config, {}).error().message, HasSubstr("needs a CAN bus"));

  config = {};
  const OwnedHeadLinks owned = absent_links(config);
  HeadLinks links = owned.get();
  links.rangefinder_bytes = nullptr;
  EXPECT_THAT(make_head_drivers(config, links).error().message,
              HasSubstr("head.rangefinder: the rangefinder needs a serial line"));
  config.rangefinder = RangefinderKind::BenewakeCan;
  EXPECT_THAT(make_head_drivers(config, links).error().message, HasSubstr("needs a CAN bus"));
}

}  // namespace
}  // namespace slamsensor::firmware
