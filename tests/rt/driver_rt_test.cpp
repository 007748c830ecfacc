// The drivers on the scan thread, from their first step through start-up, work, faults and recovery: no
// memory, no page fault, little stack. What their devices said was recorded beforehand, so that nothing but
// drivers is measured.
#include "tests/rt/taped_head.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace slamsensor::tests {
namespace {

using tools::FaultKind;
using tools::PanTiltModel;
using tools::RangefinderModel;

constexpr std::size_t kSteps = 60'000;  // a minute
constexpr std::size_t kStackMax_bytes = 64 * 1024;

struct Devices {
  const char* name;
  PanTiltModel unit;
  RangefinderModel finder;
  double rate_hz;
  std::uint32_t baud;
};

void PrintTo(const Devices& devices, std::ostream* out) {
  *out << devices.name;
}

tools::Scenario scenario_of(const Devices& devices) {
  tools::Scenario scenario;
  scenario.seed = 7;
  scenario.head.ptu.unit = devices.unit;
  scenario.head.ptu.reset_s = 3.0;
  scenario.head.rangefinder.unit = devices.finder;
  scenario.head.rangefinder.rate_hz = devices.rate_hz;
  scenario.head.rangefinder.baud = devices.baud;
  scenario.drive.stands = 1;
  const auto plan = [&](const char* device, FaultKind kind, double at_s) {
    scenario.faults.push_back({device, kind, at_s, 0.5});
  };
  plan("rangefinder", FaultKind::Silence, 30.0);
  plan("rangefinder", FaultKind::WeakSignal, 34.0);
  plan("ptu", FaultKind::PowerCycle, 35.0);
  if (!tools::is_on_bus(devices.finder)) {
    plan("rangefinder", FaultKind::Noise, 32.0);
    plan("rangefinder", FaultKind::CableOut, 36.0);
  }
  if (!tools::is_on_bus(devices.unit)) {
    plan("ptu", FaultKind::DoubleByte, 31.0);
  }
  return scenario;
}

class DriversInRealTime : public testing::TestWithParam<Devices> {
 protected:
  /// What a replay of the tape costs new drivers.
  Cost cost_of_replay() {
    ReplayedLinks links(tape_, scenario_.head);
    DriversRun run(links.get(), scenario_.head);
    if (!hold_memory()) {
      ADD_FAILURE() << "memory was held before and cannot be held now";
    }
    const Cost cost = cost_of([&] { replay(tape_, run); });
    EXPECT_EQ(links.beyond(), 0U) << "the drivers did something else than when they were recorded";
    EXPECT_EQ(run.drivers().pan_tilt->state(), hal::DeviceState::Ready) << run.drivers().pan_tilt->problem();
    EXPECT_EQ(run.drivers().rangefinder->state(), hal::DeviceState::Ready)
        << run.drivers().rangefinder->problem();
    EXPECT_GT(static_cast<double>(run.readings), 20.0 * GetParam().rate_hz);
    EXPECT_GT(run.positions, 400U);
    return cost;
  }

  tools::Scenario scenario_ = scenario_of(GetParam());
  HeadTape tape_ = record(scenario_, kSteps, [this](const firmware::HeadLinks& links) {
    return std::make_unique<DriversRun>(links, scenario_.head);
  });
};

TEST_P(DriversInRealTime, TakeNoMemoryNoPageFaultAndLittleStack) {
  expect_real_time(GetParam().name, kStackMax_bytes, [this] { return cost_of_replay(); });
}

INSTANTIATE_TEST_SUITE_P(
    Heads, DriversInRealTime,
    testing::Values(
        Devices{"PtuAndLwnxRaw", PanTiltModel::D46_17_5, RangefinderModel::Lw20, 20'000.0, 921'600},
        Devices{"FastPtuAndLwnx", PanTiltModel::FastE, RangefinderModel::Sf45, 1000.0, 921'600},
        Devices{"PtuAndBenewake", PanTiltModel::E46_17_5, RangefinderModel::Tf03, 1000.0, 115'200},
        Devices{"CanopenAndBenewakeCan", PanTiltModel::CanOpen, RangefinderModel::Tf03Can, 1000.0, 115'200},
        Devices{"CanopenAndPointLaser", PanTiltModel::CanOpen, RangefinderModel::Lds70a, 1000.0, 115'200},
        Devices{"PtuAndPointLaser", PanTiltModel::D46_17_5, RangefinderModel::LaserAceIm, 1000.0, 115'200}),
    [](const auto& devices) { return std::string(devices.param.name); });

}  // namespace
}  // namespace slamsensor::tests
