// Every product of the tables, as it leaves the factory, with the driver that a user gets who sets nothing
// but what the product is: it gets Ready and its distances are true.
#include "hal/rangefinder/benewake_driver.hpp"
#include "hal/rangefinder/lwnx_driver.hpp"
#include "hal/rangefinder/point_laser.hpp"
#include "tools/emulator/emulated_port.hpp"
#include "tools/emulator/rangefinder/emulated_lwnx.hpp"
#include "tools/emulator/rangefinder/emulated_point_laser.hpp"
#include "tools/emulator/rangefinder/emulated_tf03.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;
using Driver = std::unique_ptr<hal::Rangefinder>;
using Made = tl::expected<Driver, hal::InitError>;

constexpr double kTruth_m = 5.0;
constexpr double kLost_m = -1.0;

/// Sees something at 5 m, and every 16th time nothing.
class Scene final : public RangeScene {
 public:
  Target shoot(Stamp) override {
    return ++shots_ % 16 == 0 ? Target{TargetKind::LostShot, kLost_m, 0.0}
                              : Target{TargetKind::Target, kTruth_m, 0.3};
  }
  void reported(Stamp, Stamp) override {}

 private:
  std::uint64_t shots_ = 0;
};

struct Outcome {
  std::size_t distances = 0;
  std::size_t others = 0;
};

/// Runs until the driver is Ready, and then some readings more. All distances must be true.
template <typename Device, typename Settings, typename Make>
void expect_true_distances(const Settings& settings, const Make& make, const std::string& name) {
  EmulatedPort port(1);
  Scene scene;
  Device device(settings, port, scene);
  port.attach(device);
  SimClock clock;
  MemoryLink link(port, clock, {});
  Made made = make(link);
  ASSERT_TRUE(made) << name << ": " << made.error().message;
  hal::Rangefinder& driver = **made;
  Outcome outcome;
  const auto is_enough = [&] { return outcome.distances >= 40 && outcome.others >= 2; };
  while (clock.now < 60s && !is_enough()) {
    clock.now += 1ms;
    port.advance(clock.now);
    driver.step(clock.now);
    std::array<hal::RangeSample, 256> samples;
    const std::size_t count = driver.take(samples);
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_distance = samples[i].echo == hal::Echo::Return;
      ++(is_distance ? outcome.distances : outcome.others);
      if (is_distance) {
        ASSERT_NEAR(samples[i].range_m, kTruth_m, 0.051) << name;  // a decimetre is the coarsest resolution
      }
    }
  }
  EXPECT_EQ(driver.state(), hal::DeviceState::Ready) << name << ": " << driver.problem();
  EXPECT_GE(outcome.distances, 40U) << name;
  EXPECT_GE(outcome.others, 2U) << name;
  EXPECT_GT(driver.info().rate_hz, 0.0) << name;
}

TEST(DefaultPairs, EveryLightWare) {
  constexpr unsigned kModels = static_cast<unsigned>(LwnxModel::Grf500) + 1;
  for (unsigned i = 0; i < kModels; ++i) {
    LwnxSettings settings;
    settings.product = lwnx_product(static_cast<LwnxModel>(i));
    expect_true_distances<EmulatedLwnx>(
        settings, [](hal::ByteLink& link) { return hal::make_lwnx_rangefinder({}, link); },
        settings.product.name);
  }
}

TEST(DefaultPairs, EveryBenewake) {
  for (const hal::BenewakeModel model :
       {hal::BenewakeModel::Tf03, hal::BenewakeModel::TfMini, hal::BenewakeModel::TfMiniPlus,
        hal::BenewakeModel::TfMiniS, hal::BenewakeModel::Tf02}) {
    hal::BenewakeSerialConfig config;
    config.device.model = model;
    config.device.rate_hz = std::min(1000.0, hal::benewake_product(model).rate_max_hz);
    config.device.range.range_max_m = model == hal::BenewakeModel::Tf03 ? 180.0 : 22.0;
    expect_true_distances<EmulatedTf03>(
        tf03_settings(model), [&](hal::ByteLink& link) { return hal::make_benewake_serial(config, link); },
        std::string(hal::benewake_product(model).name));
  }
}

TEST(DefaultPairs, EveryPointLaser) {
  expect_true_distances<EmulatedPointLaser>(
      lds70a_settings(),
      [](hal::ByteLink& link) { return hal::make_point_laser(hal::astech_lds70a(), link); }, "LDS70A");
  expect_true_distances<EmulatedPointLaser>(
      laserace_im_settings(),
      [](hal::ByteLink& link) { return hal::make_point_laser(hal::mdl_laserace_im_hr_unverified(), link); },
      "LaserAce");
}

}  // namespace
}  // namespace slamsensor::tools
