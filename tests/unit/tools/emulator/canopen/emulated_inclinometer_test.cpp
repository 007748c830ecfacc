// The emulated inclinometer on a bus in memory, and the driver that reads it.

#include "tools/emulator/canopen/emulated_inclinometer.hpp"

#include "core/config.hpp"
#include "core/reading.hpp"
#include "hal/inclination/cia410.hpp"
#include "tests/support/source_tree.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/memory_can_bus.hpp"
#include "tools/emulator/scenario.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

using core::kDegree;

class InclinometerRig {
 public:
  explicit InclinometerRig(const InclinometerSettings& settings = {})
      : sink_(bus_.add_device_node()), device(settings, sink_), link_(bus_, clock_) {
    bus_.attach(sink_, device);
    driver = std::move(hal::Cia410Inclinometer::create({}, link_).value());
  }

  void run(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      clock_.now += std::chrono::milliseconds(1);
      bus_.advance(clock_.now);
      driver->step(clock_.now);
    }
  }

  std::optional<hal::Inclination> measured() {
    run(400);
    return driver->take();
  }

  void lean(double roll_deg, double pitch_deg) {
    device.lean(roll_deg * kDegree, pitch_deg * kDegree, clock_.now);
  }
  bool inject(FaultKind kind, double seconds = 0.0) {
    return device.inject({kind, clock_.now, hal::from_seconds(seconds)});
  }

 private:
  SimClock clock_{std::chrono::seconds(1)};
  MemoryCanBus bus_;
  FrameSink& sink_;

 public:
  EmulatedInclinometer device;

 private:
  MemoryCanLink link_;

 public:
  std::unique_ptr<hal::Cia410Inclinometer> driver;
};

TEST(EmulatedInclinometer, DriverReadsWhatItLeansBy) {
  for (const std::uint16_t resolution : std::initializer_list<std::uint16_t>{1, 10, 100}) {
    for (const bool has_32_bits : {false, true}) {
      InclinometerSettings settings;
      settings.resolution = resolution;
      settings.has_32_bits = has_32_bits;
      settings.begin = DeviceBegin::PowerUp;
      InclinometerRig rig(settings);
      for (const core::Attitude& attitude :
           {core::Attitude{5.0, 0.0}, core::Attitude{-3.0, 4.0}, core::Attitude{12.0, -20.0}}) {
        rig.lean(attitude.roll_rad, attitude.pitch_rad);
        static_cast<void>(rig.measured());
        const auto got = rig.measured();
        ASSERT_TRUE(got) << rig.driver->problem();
        EXPECT_NEAR(got->roll_rad, attitude.roll_rad * kDegree, 0.0011 * resolution * kDegree);
        EXPECT_NEAR(got->pitch_rad, attitude.pitch_rad * kDegree, 0.0011 * resolution * kDegree);
      }
      EXPECT_EQ(rig.driver->model().view(), "emulated inclinometer");
    }
  }
}

TEST(EmulatedInclinometer, DriverOutlivesItsFaults) {
  for (const FaultKind kind : {FaultKind::PowerCycle, FaultKind::NodeReset, FaultKind::Silence,
                               FaultKind::SdoAbort, FaultKind::SdoSilence, FaultKind::Emergency}) {
    InclinometerRig rig;
    rig.lean(2.0, 1.0);
    ASSERT_TRUE(rig.measured());
    ASSERT_TRUE(rig.inject(kind, 2.0));
    rig.run(6000);
    EXPECT_EQ(rig.driver->state(), hal::DeviceState::Ready)
        << static_cast<int>(kind) << ": " << rig.driver->problem();
    const auto got = rig.measured();
    ASSERT_TRUE(got) << static_cast<int>(kind);
    EXPECT_NEAR(got->roll_rad, 2.0 * kDegree, 0.01 * kDegree);
  }
  InclinometerRig rig;
  EXPECT_FALSE(rig.inject(FaultKind::MissedSteps));
}

TEST(EmulatedInclinometer, BeyondItsRangeTheDriverBelievesNothing) {
  InclinometerRig rig;
  ASSERT_TRUE(rig.measured());
  rig.lean(70.0, 0.0);
  rig.run(300);
  static_cast<void>(rig.driver->take());
  EXPECT_FALSE(rig.measured());
  EXPECT_EQ(rig.driver->state(), hal::DeviceState::Faulted);
  rig.lean(7.0, 0.0);
  rig.run(1500);
  EXPECT_TRUE(rig.measured()) << rig.driver->problem();
}

TEST(EmulatedInclinometer, OfAScenarioReportsHowTheMountLeans) {
  const auto world = tests::source_tree() / "config/worlds/park.toml";
  const auto scenario = parse_scenario("world = \"" + world.string() +
                                           "\"\nhead = \"fast\"\n[mount]\nroll_deg = 3.0\npitch_deg = -4.0\n"
                                           "[inclinometer]\nunit = \"cia410\"\nnode = 17\nresolution = 1\n",
                                       "leaning", world.parent_path());
  ASSERT_TRUE(scenario) << scenario.error().message;
  const auto head = InProcessHead::create(*scenario);
  ASSERT_TRUE(head) << head.error().message;
  ASSERT_NE((*head)->head().bus(), nullptr);
  MemoryCanLink link(*(*head)->head().bus(), (*head)->head().clock());
  hal::Cia410Config config;
  config.node = 17;
  const auto driver = std::move(hal::Cia410Inclinometer::create(config, link).value());
  std::optional<hal::Inclination> got;
  for (int i = 0; i < 1000 && !got; ++i) {
    (*head)->advance((*head)->now() + std::chrono::milliseconds(1));
    driver->step((*head)->now());
    got = driver->take();
  }
  ASSERT_TRUE(got) << driver->problem();
  EXPECT_NEAR(got->roll_rad, 3.0 * kDegree, 0.001 * kDegree);
  EXPECT_NEAR(got->pitch_rad, -4.0 * kDegree, 0.001 * kDegree);
}

}  // namespace
}  // namespace slamsensor::tools
