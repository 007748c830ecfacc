// The head with the devices of its profiles: spoken to in bytes, as a host would, and checked against the
// truth.
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;

constexpr double kArcSecond = std::numbers::pi / (180.0 * 3600.0);

Scenario scenario_of(HeadKind kind) {
  Scenario scenario;
  scenario.head = head_profile(kind);
  scenario.head.ptu.begin = DeviceBegin::Ready;
  scenario.world.rangefinder.noise_sigma_m = 0.0;
  scenario.world.walls = {
      {-20, -20, 20, -20, 9}, {20, -20, 20, 20, 9}, {20, 20, -20, 20, 9}, {-20, 20, -20, -20, 9}};
  scenario.world.stands = {{{0.0, 0.0, 0.0}}};
  scenario.truth_max = 1'000'000;
  return scenario;
}

/// A host without a driver.
class Host {
 public:
  explicit Host(const Scenario& scenario) {
    auto made = InProcessHead::create(scenario);
    EXPECT_TRUE(made.has_value()) << (made ? "" : made.error().message);
    run_ = std::move(*made);
    pass(1ms);
  }

  InProcessHead& run() { return *run_; }

  void pass(Stamp time) {
    const Stamp end = run_->now() + time;
    while (run_->now() < end) {
      run_->advance(std::min(end, run_->now() + 1ms));
      read(run_->ptu_bytes(), ptu_);
      read(run_->rangefinder_bytes(), laser_);
    }
  }

  /// What the unit says within `time` of `command`.
  std::string ask(const std::string& command, Stamp time) {
    ptu_.clear();
    EXPECT_EQ(
        run_->ptu_bytes()->write({reinterpret_cast<const std::uint8_t*>(command.data()), command.size()}),
        hal::LinkStatus::Ok);
    pass(time);
    return ptu_;
  }

  std::string take_laser() { return std::exchange(laser_, {}); }

  void tell_laser(const std::vector<std::uint8_t>& bytes) {
    EXPECT_EQ(run_->rangefinder_bytes()->write(bytes), hal::LinkStatus::Ok);
  }

 private:
  void read(hal::ByteLink* link, std::string& into) {
    std::array<std::uint8_t, 512> bytes;
    link->service(run_->now());
    for (hal::ByteRead got = link->read(bytes); got.count > 0; got = link->read(bytes)) {
      into.append(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(got.count));
    }
  }

  std::unique_ptr<InProcessHead> run_;
  std::string ptu_;
  std::string laser_;
};

TEST(RealDevices, ThePaperUnitPansAtAThousandPositionsASecond) {
  Scenario scenario = scenario_of(HeadKind::Fast);
  scenario.head.ptu = {};
  scenario.head.ptu.begin = DeviceBegin::Ready;
  Host host(scenario);
  EXPECT_NE(host.ask("ED FT PP ", 200ms).find("* 0\r\n"), std::string::npos);
  EXPECT_NE(host.ask("PS1000 PP2500 ", 100ms).find("*\r\n*\r\n"), std::string::npos);
  const PointingTruth& truth = host.run().head().pointing();
  const Stamp now = host.run().now();
  const double moved_rad = truth.angles_at(now).pan_rad - truth.angles_at(now - 50ms).pan_rad;
  EXPECT_NEAR(moved_rad, 50.0 * 185.1428 * kArcSecond, 1e-6);
  host.pass(3s);
  EXPECT_NEAR(truth.angles_at(host.run().now()).pan_rad, 2500.0 * 185.1428 * kArcSecond, 1e-9);
}

TEST(RealDevices, TheFastUnitIsAtThreeHundredDegreesASecondAtOnce) {
  Host host(scenario_of(HeadKind::Fast));
  host.ask("ED FT PS46667 PP20000 ", 60ms);
  const PointingTruth& truth = host.run().head().pointing();
  const Stamp now = host.run().now();
  const double speed_radps = (truth.angles_at(now).pan_rad - truth.angles_at(now - 10ms).pan_rad) / 0.010;
  EXPECT_NEAR(speed_radps, 46'667.0 * 23.142857 * kArcSecond, 1e-3);
}

TEST(RealDevices, TheFastLaserReportsTwentyThousandShotsASecondWithTheirTruth) {
  Host host(scenario_of(HeadKind::Fast));
  host.pass(500ms);
  const std::vector<std::uint8_t> product = {0xAA, 0x40, 0x00, 0x00, 0x70, 0x9F};
  const std::vector<std::uint8_t> high_speed = {0xAA, 0x81, 0x00, 0x46, 0x01, 0x0D, 0x70};
  const std::vector<std::uint8_t> stream = {0xAA, 0x41, 0x01, 0x1E, 0x01, 0x00, 0x00, 0x00, 0xFE, 0x8A};
  for (const auto& command : {product, product, product, high_speed, stream}) {
    host.tell_laser(command);
    host.pass(100ms);
  }
  static_cast<void>(host.run().head().take_truth());
  host.take_laser();
  host.pass(1s);
  const auto truth = host.run().head().take_truth();
  EXPECT_NEAR(static_cast<double>(truth.size()), 20'000.0, 400.0);
  EXPECT_NEAR(static_cast<double>(host.take_laser().size()), 100.0 * 407.0, 3.0 * 407.0);
  for (const ShotTruth& shot : truth) {
    EXPECT_NEAR(shot.target.range_m, 20.0, 0.051);  // straight ahead; the world's resolution
    EXPECT_GE(shot.on_wire, shot.measured);
  }
}

TEST(RealDevices, EveryUnitOfTheProfilesSpeaksOnItsLine) {
  for (std::size_t i = 0; i < kRangefinderUnits.size(); ++i) {
    Scenario scenario = scenario_of(HeadKind::Paper);
    scenario.head.rangefinder.unit = static_cast<RangefinderModel>(i);
    EXPECT_TRUE(EmulatedHead::create(scenario).has_value()) << kRangefinderUnits[i].word;
  }
  for (const PanTiltModel unit : {PanTiltModel::D46_17_5, PanTiltModel::D46_70, PanTiltModel::E46_17_5,
                                  PanTiltModel::D300E, PanTiltModel::FastE}) {
    Scenario scenario = scenario_of(HeadKind::Paper);
    scenario.head.ptu.unit = unit;
    Host host(scenario);
    EXPECT_NE(host.ask("ED FT PP ", 300ms).find("* 0\r\n"), std::string::npos) << text_of(unit).word;
  }
}

TEST(RealDevices, ThePaperLaserWritesAThousandLinesASecond) {
  Host host(scenario_of(HeadKind::Paper));
  host.pass(1s);
  host.take_laser();
  host.pass(1s);
  const std::string text = host.take_laser();
  EXPECT_NEAR(static_cast<double>(std::count(text.begin(), text.end(), '\n')), 1000.0, 3.0);
  EXPECT_NE(text.find("20.0"), std::string::npos) << text.substr(0, 40);
}

TEST(RealDevices, ALaserOnTheBusSendsAFrameForEachReading) {
  Scenario scenario = scenario_of(HeadKind::Fast);
  scenario.head.rangefinder.unit = RangefinderModel::Tf03Can;
  scenario.head.rangefinder.rate_hz = 1000.0;
  auto made = InProcessHead::create(scenario);
  ASSERT_TRUE(made.has_value()) << made.error().message;
  InProcessHead& run = **made;
  EXPECT_EQ(run.rangefinder_bytes(), nullptr);
  EXPECT_NE(run.ptu_bytes(), nullptr);
  EXPECT_EQ(run.ptu_can(), nullptr);
  ASSERT_NE(run.rangefinder_can(), nullptr);
  std::size_t frames = 0;
  while (run.now() < 2s) {
    run.advance(run.now() + 1ms);
    run.rangefinder_can()->service(run.now());
    for (hal::CanRead read = run.rangefinder_can()->receive(); read.status == hal::LinkStatus::Ok;
         read = run.rangefinder_can()->receive()) {
      const unsigned cm = read.frame.data[0] + 256U * read.frame.data[1];
      EXPECT_NEAR(cm, 2000.0, 6.0);
      frames += run.now() > 1s ? 1U : 0U;
    }
  }
  EXPECT_NEAR(static_cast<double>(frames), 1000.0, 3.0);
  EXPECT_TRUE(run.head().inject("can", FaultKind::LostFrame, Stamp{}));
}

TEST(RealDevices, TheSameScenarioGivesTheSameBytes) {
  const auto run = [](std::uint64_t seed) {
    Scenario scenario = scenario_of(HeadKind::Fast);
    scenario.seed = seed;
    scenario.rates = {{"ptu", FaultKind::CorruptByte, FaultRhythm::Chance, 0.3},
                      {"ptu", FaultKind::LateReply, FaultRhythm::Chance, 0.7, 0.0, 1e9, 0.1}};
    Host host(scenario);
    std::string all = host.ask("ED FT ", 100ms);
    for (int i = 0; i < 40; ++i) {
      all += host.ask("PP TP ", 50ms);
    }
    return all;
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

}  // namespace
}  // namespace slamsensor::tools
