#include "tools/emulator/emulated_head.hpp"

#include "tests/unit/tools/emulator/small_devices.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slamsensor::tools {
namespace {

/// A square room of 20 m around the origin, exact ranges, and the sensor 1.5 m above flat ground.
Scenario room() {
  Scenario scenario;
  scenario.world.rangefinder.noise_sigma_m = 0.0;
  scenario.world.rangefinder.resolution_m = 0.0;
  scenario.world.walls = {
      {-10, -10, 10, -10, 5}, {10, -10, 10, 10, 5}, {10, 10, -10, 10, 5}, {-10, 10, -10, -10, 5}};
  scenario.world.stands = {{{0.0, 0.0, 0.0}}, {{5.0, 0.0, 0.0}}, {{-5.0, 0.0, 0.0}}};
  scenario.drive.period_s = 2.0;
  scenario.truth_max = 100'000;
  return scenario;
}

std::unique_ptr<EmulatedHead> head_of(const Scenario& scenario) {
  auto head = EmulatedHead::create(scenario, make_small_devices);
  EXPECT_TRUE(head.has_value()) << (head ? "" : head.error().message);
  return head ? std::move(*head) : nullptr;
}

std::vector<std::uint8_t> laser_bytes(EmulatedHead& head, Stamp end, Stamp step) {
  std::vector<std::uint8_t> all;
  std::array<WireByte, 4096> bytes;
  head.rangefinder_port()->set_host_baud(115'200);
  for (Stamp now = head.clock().now + step; now <= end; now += step) {
    head.advance(now);
    const std::size_t count = head.rangefinder_port()->host_take(bytes, now);
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(bytes[i].value);
    }
  }
  return all;
}

TEST(EmulatedHead, ShotsGoWhereTheUnitTrulyPoints) {
  const auto head = head_of(room());
  ASSERT_NE(head, nullptr);
  head->advance(1s);
  const auto truth = head->take_truth();
  ASSERT_EQ(truth.size(), 1000U);
  for (const ShotTruth& shot : truth) {
    const double pan_rad = 0.5 * hal::to_seconds(shot.measured);
    EXPECT_DOUBLE_EQ(shot.angles.pan_rad, pan_rad);
    EXPECT_EQ(shot.target.kind, TargetKind::Target);
    EXPECT_NEAR(shot.target.range_m, 10.0 / (std::cos(pan_rad) * std::cos(0.02)), 1e-9);
  }
  EXPECT_TRUE(head->take_truth().empty());
}

TEST(EmulatedHead, StandsChangeAtTheirTimes) {
  const auto head = head_of(room());
  ASSERT_NE(head, nullptr);
  head->advance(10s);
  ASSERT_EQ(head->visits().size(), 3U);
  EXPECT_EQ(head->visits()[0].at, 0s);
  EXPECT_EQ(head->visits()[1].at, 2s);
  EXPECT_EQ(head->visits()[2].at, 4s);
  const auto truth = head->take_truth();
  const double pan_rad = 0.5 * 2.001;
  EXPECT_NEAR(truth.at(2000).target.range_m, 5.0 / (std::cos(pan_rad) * std::cos(0.02)), 1e-9);
}

TEST(EmulatedHead, OrWhenAScanHasEnded) {
  Scenario scenario = room();
  scenario.change = StandChange::OnScanEnd;
  const auto head = head_of(scenario);
  ASSERT_NE(head, nullptr);
  head->advance(10s);
  EXPECT_EQ(head->visits().size(), 1U);
  EXPECT_TRUE(head->next_stand());
  EXPECT_EQ(head->visits().back().at, 10s);
  EXPECT_TRUE(head->next_stand());
  EXPECT_FALSE(head->next_stand());
  EXPECT_EQ(head->stands().taken(), 3U);
}

TEST(EmulatedHead, AKidnapComesAtItsTimeInTheMiddleOfAScan) {
  Scenario scenario = room();
  scenario.change = StandChange::OnScanEnd;
  scenario.kidnaps = {{0.5, {8.0, 0.0, 0.0}}};
  const auto head = head_of(scenario);
  ASSERT_NE(head, nullptr);
  head->advance(1s);
  const auto truth = head->take_truth();
  EXPECT_NEAR(truth.at(498).target.range_m, 10.0 / (std::cos(0.2495) * std::cos(0.02)), 1e-9);
  EXPECT_NEAR(truth.at(500).target.range_m, 2.0 / (std::cos(0.2505) * std::cos(0.02)), 1e-9);
  EXPECT_EQ(head->visits().back().visit.kind, VisitKind::Kidnap);
}

TEST(EmulatedHead, PlannedFaultsReachTheirDevicesAndAreLogged) {
  Scenario scenario = room();
  scenario.faults = {{"rangefinder", FaultKind::NoReturns, 0.5, 0.1},
                     {"rangefinder", FaultKind::DropByte, 0.7, 0.0},
                     {"ptu", FaultKind::MissedSteps, 0.6, 0.0},
                     {"ptu", FaultKind::LimitReport, 0.8, 0.0}};
  const auto head = head_of(scenario);
  ASSERT_NE(head, nullptr);
  head->advance(1s);
  ASSERT_EQ(head->faults().size(), 4U);
  EXPECT_EQ(head->faults()[1].due.fault.at, 600ms);
  EXPECT_TRUE(head->faults()[1].known);
  EXPECT_TRUE(head->faults()[2].known);
  EXPECT_FALSE(head->faults()[3].known);  // this little unit has none
  EXPECT_TRUE(head->inject("rangefinder", FaultKind::Stall, 10ms));
  EXPECT_FALSE(head->inject("can", FaultKind::BusOff, 10ms));
  EXPECT_EQ(head->faults().size(), 6U);
}

TEST(EmulatedHead, TheSizeOfTheStepsChangesNoByte) {
  Scenario scenario = room();
  scenario.world.rangefinder.noise_sigma_m = 0.1;
  scenario.world.rangefinder.drop_out_share = 0.05;
  scenario.kidnaps = {{0.3, {3.0, 1.0, 0.2}}};
  scenario.rates = {{"rangefinder", FaultKind::CorruptByte, FaultRhythm::Chance, 0.05},
                    {"rangefinder", FaultKind::Stall, FaultRhythm::Chance, 0.5, 0.0, 1e9, 0.02},
                    {"rangefinder", FaultKind::DoubleByte, FaultRhythm::Chance, 0.1}};
  const auto run = [&](Stamp step) {
    const auto head = head_of(scenario);
    return laser_bytes(*head, 3s, step);
  };
  const auto fine = run(100us);
  EXPECT_EQ(fine.size() / 1000, 6U);
  EXPECT_EQ(run(20ms), fine);
  scenario.seed = 2;
  EXPECT_NE(run(20ms), fine);
}

TEST(EmulatedHead, DropOutsAreLostShotsAndEmptySkyIsNothing) {
  Scenario scenario = room();
  scenario.world.rangefinder.drop_out_share = 0.25;
  scenario.world.walls.pop_back();  // open to the left... and the ground ends the view 75 m out
  const auto head = head_of(scenario);
  ASSERT_NE(head, nullptr);
  head->advance(4s);
  std::size_t lost = 0;
  for (const ShotTruth& shot : head->take_truth()) {
    lost += shot.target.kind == TargetKind::LostShot ? 1U : 0U;
    EXPECT_NE(shot.target.kind, TargetKind::Nothing);
  }
  EXPECT_NEAR(static_cast<double>(lost), 1000.0, 110.0);
}

TEST(EmulatedHead, TruthIsBounded) {
  Scenario scenario = room();
  scenario.truth_max = 100;
  const auto head = head_of(scenario);
  head->advance(1s);
  const auto truth = head->take_truth();
  ASSERT_EQ(truth.size(), 100U);
  EXPECT_EQ(truth.back().measured, 1s);
}

TEST(EmulatedHead, ImpossibleScenariosAreRefused) {
  Scenario scenario = room();
  scenario.world.stems = {{5.0, 0.0}};  // at the second stand
  EXPECT_FALSE(EmulatedHead::create(scenario, make_small_devices).has_value());
  scenario = room();
  scenario.world.stems = {{0.0, 7.0}};
  scenario.kidnaps = {{1.0, {0.0, 7.0, 0.0}}};
  EXPECT_NE(EmulatedHead::create(scenario, make_small_devices).error().message.find("kidnap"),
            std::string::npos);
  scenario = room();
  scenario.faults = {{"ptu", FaultKind::WeakSignal, 1.0, 0.0}};
  EXPECT_EQ(EmulatedHead::create(scenario, make_small_devices).error().message,
            "kind = \"weak_signal\" is no fault of this ptu");
}

TEST(InProcessHead, LinksAreTheDriversEndOfTheDevices) {
  auto run = InProcessHead::create(room(), make_small_devices);
  ASSERT_TRUE(run.has_value());
  InProcessHead& head = **run;
  ASSERT_NE(head.rangefinder_bytes(), nullptr);
  EXPECT_NE(head.ptu_bytes(), nullptr);
  EXPECT_EQ(head.ptu_can(), nullptr);
  std::size_t bytes = 0;
  std::array<std::uint8_t, 256> buffer;
  while (head.now() < 1s) {
    head.advance(head.now() + 1ms);
    head.rangefinder_bytes()->service(head.now());
    bytes += head.rangefinder_bytes()->read(buffer).count;
  }
  EXPECT_NEAR(static_cast<double>(bytes), 2000.0, 6.0);
}

}  // namespace
}  // namespace slamsensor::tools
