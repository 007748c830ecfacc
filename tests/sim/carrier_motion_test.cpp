// The scan scheduler on emulated devices, through their bytes: a carrier that moves during a scan, and a head
// whose devices fail in the middle of one. How sure the detector is in how many worlds is measured without
// devices, in motion_rates_test.cpp.

#include "tests/support/source_tree.hpp"
#include "tools/drive/byte_drive.hpp"
#include "tools/emulator/head_devices.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace slamsensor::tools {
namespace {

using firmware::ScanAbort;
using firmware::SchedulerEvent;
using firmware::SchedulerState;

const std::filesystem::path kConfigDir = tests::source_tree() / "config";
constexpr double kMilliDegrees = 1000.0 / core::kDegree;
constexpr double kLimit_s = 900.0;

Scenario park_scenario(std::uint64_t seed) {
  auto scenario = load_scenario(kConfigDir / "scenarios" / "fast.toml", HeadKind::Paper);
  EXPECT_TRUE(scenario) << scenario.error().message;
  scenario->seed = seed;
  scenario->kidnaps.clear();
  return *scenario;
}

/// 26 scanlines by 1.03 deg, as in experiments III and IV.
firmware::SensorHeadConfig whole_scan() {
  firmware::SensorHeadConfig config;
  config.scan.tilt_min_rad = -340.0 * firmware::kPaperStep_rad;
  config.scan.tilt_max_rad = 160.0 * firmware::kPaperStep_rad;
  config.scan.tilt_step_rad = 20.0 * firmware::kPaperStep_rad;
  return config;
}

/// Six scanlines of 2 s.
firmware::SensorHeadConfig short_scan() {
  firmware::SensorHeadConfig config = whole_scan();
  config.scan.pan_min_rad = -1000.0 * firmware::kPaperStep_rad;
  config.scan.pan_max_rad = 1000.0 * firmware::kPaperStep_rad;
  config.scan.tilt_min_rad = -40.0 * firmware::kPaperStep_rad;
  config.scan.tilt_max_rad = 60.0 * firmware::kPaperStep_rad;
  return config;
}

std::unique_ptr<ByteDrive> drive_of(const Scenario& scenario, const firmware::SensorHeadConfig& config) {
  auto drive = ByteDrive::create(scenario, config);
  EXPECT_TRUE(drive) << drive.error().message;
  return std::move(*drive);
}

/// Runs until scanline `line` of a scan is being swept.
void run_into(ByteDrive& drive, std::uint32_t line) {
  const auto& scheduler = drive.sensor().scheduler();
  for (int i = 0; i < 10'000; ++i) {
    if (scheduler.pass() == firmware::ScanPass::Scan && scheduler.state() == SchedulerState::Sweeping &&
        scheduler.line() >= line) {
      drive.run(0.5);
      return;
    }
    drive.run(0.1);
  }
  FAIL() << drive.sensor().problem();
}

std::uint64_t aborts(const ByteDrive& drive, ScanAbort reason) {
  const auto event =
      static_cast<std::size_t>(SchedulerEvent::AbortedPanTiltLost) + static_cast<std::size_t>(reason);
  return drive.sensor().scheduler().count(static_cast<SchedulerEvent>(event));
}

std::uint64_t all_aborts(const ByteDrive& drive) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < firmware::kScanAborts; ++i) {
    sum += aborts(drive, static_cast<ScanAbort>(i));
  }
  return sum;
}

/// When the scan at the first stand sweeps its scanline `line`, s.
double time_of_line(const Scenario& scenario, std::uint32_t line) {
  const auto drive = drive_of(scenario, whole_scan());
  run_into(*drive, line);
  return hal::to_seconds(drive->head().now());
}

struct Carry {
  std::string_view name;
  double distance_m;
  double turn_rad;
  double duration_s;        ///< 0: at once
  std::uint32_t line = 20;  ///< during which it begins
};

class CarriedSensor : public testing::TestWithParam<Carry> {};

TEST_P(CarriedSensor, ScansAreRejectedUntilItStandsStill) {
  const Carry& carry = GetParam();
  Scenario scenario = park_scenario(31);
  scenario.drive.stands = 1;
  const double begin_s = time_of_line(scenario, carry.line);
  const core::Pose2 from_W = drive_of(scenario, whole_scan())->head().head().visits().front().visit.pose_W;
  const int steps = std::max(1, static_cast<int>(carry.duration_s / 0.1));
  core::Pose2 to_W = from_W;
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    to_W = from_W;
    to_W.x_m += share * carry.distance_m;
    to_W.heading_rad += share * carry.turn_rad;
    scenario.kidnaps.push_back({begin_s + share * carry.duration_s, to_W});
  }
  const auto drive = drive_of(scenario, whole_scan());
  const auto driven = drive->next_scan(kLimit_s);
  ASSERT_TRUE(driven) << drive->sensor().problem();
  EXPECT_GE(aborts(*drive, ScanAbort::CarrierMoved), 1U) << carry.name;
  EXPECT_EQ(all_aborts(*drive), aborts(*drive, ScanAbort::CarrierMoved));
  EXPECT_EQ(drive->sensor().last_abort(), ScanAbort::CarrierMoved);
  // What moved while the lowest lines were swept may have been seen by nothing but the ground.
  EXPECT_GE(hal::to_seconds(driven->ended.middle), begin_s + carry.duration_s);
  EXPECT_EQ(driven->scanlines.size(), 26U);
  EXPECT_LT((driven->stand_W.translation() - to_W.translation()).norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    Carries, CarriedSensor,
    testing::Values(Carry{"pushed 0.5 m", 0.5, 0.0, 0.0}, Carry{"lifted 3 m", 3.0, 0.0, 0.0},
                    Carry{"turned 3 deg", 0.0, 3.0 * core::kDegree, 0.0},
                    Carry{"turned 40 deg", 0.0, 40.0 * core::kDegree, 1.0},
                    Carry{"crept 0.02 m/s", 2.4, 0.0, 120.0, 4}, Carry{"walked 0.5 m/s", 5.0, 1.0, 10.0}),
    [](const auto& carry) {
      std::string name(carry.param.name);
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
      return name;
    });

TEST(SensorAtRest, ScansAreNotRejected) {
  Scenario scenario = park_scenario(32);
  scenario.drive.stands = 3;
  const auto drive = drive_of(scenario, whole_scan());
  for (int i = 0; i < 3; ++i) {
    const auto driven = drive->next_scan(kLimit_s);
    ASSERT_TRUE(driven) << drive->sensor().problem();
  }
  EXPECT_EQ(all_aborts(*drive), 0U);
  EXPECT_GT(drive->sensor().motion().count(core::MotionEvent::LinesJudged), 20U);
}

TEST(MissedSteps, AreSeenByWhatTheLaserSees) {
  // The unit tells the positions that it believes in, so that nothing but the world shows the loss.
  int rejected = 0;
  int large = 0;
  for (std::uint64_t seed = 41; seed < 45; ++seed) {
    Scenario scenario = park_scenario(seed);
    scenario.drive.stands = 1;
    const auto drive = drive_of(scenario, whole_scan());
    run_into(*drive, 20);
    const PointingTruth& pointing = drive->head().head().pointing();
    const hal::AxisStatus& pan = drive->drivers().pan_tilt->axis(hal::Axis::Pan);
    ASSERT_TRUE(drive->head().head().inject(kPtuName, FaultKind::MissedSteps, {}));
    drive->run(6.0);
    while (pan.moving) {
      drive->run(0.1);
    }
    drive->run(0.2);
    const double off_rad = pointing.angles_at(drive->head().now()).pan_rad - pan.position_rad;
    const bool is_large = std::abs(off_rad) > 1.5 * whole_scan().motion.angle_min_rad;
    large += is_large ? 1 : 0;
    drive->run(20.0);
    const bool is_rejected = aborts(*drive, ScanAbort::CarrierMoved) > 0;
    rejected += is_rejected ? 1 : 0;
    EXPECT_TRUE(is_rejected || !is_large) << "seed " << seed << ": " << off_rad * kMilliDegrees << " mdeg";
  }
  EXPECT_GE(large, 1) << "the seeds show nothing";
  EXPECT_GE(rejected, large);
}

struct HeadFault {
  PanTiltModel unit;
  std::string_view device;
  FaultKind kind;
  double duration_s;
  DriveMemory encoder = DriveMemory::Absolute;
};

class FailingHead : public testing::TestWithParam<HeadFault> {};

TEST_P(FailingHead, EndsTheScanOrNotAndTheNextOneIsSound) {
  const HeadFault& fault = GetParam();
  Scenario scenario = park_scenario(51);
  scenario.drive.stands = 1;
  scenario.head.ptu.unit = fault.unit;
  scenario.head.ptu.encoder = fault.encoder;
  scenario.head.rangefinder.unit = is_on_bus(fault.unit) ? RangefinderModel::Tf03Can : RangefinderModel::Lw20;
  const auto drive = drive_of(scenario, short_scan());
  run_into(*drive, 2);
  ASSERT_TRUE(drive->head().head().inject(fault.device, fault.kind, hal::from_seconds(fault.duration_s)));
  for (int i = 0; i < 2; ++i) {
    const auto driven = drive->next_scan(kLimit_s);
    ASSERT_TRUE(driven) << drive->sensor().problem();
    EXPECT_EQ(driven->scanlines.size() + driven->ended.lines_rejected, 6U);
    EXPECT_LT(driven->pan.rms_rad * kMilliDegrees, 30.0) << "scan " << i << " after the fault";
  }
  const bool is_loss = fault.duration_s > 0.0;
  EXPECT_GE(all_aborts(*drive), is_loss ? 1U : 0U);
  EXPECT_TRUE(drive->sensor().problem().empty()) << drive->sensor().problem();
}

INSTANTIATE_TEST_SUITE_P(
    Faults, FailingHead,
    testing::Values(HeadFault{PanTiltModel::D46_17_5, kPtuName, FaultKind::LimitReport, 0.0},
                    HeadFault{PanTiltModel::D46_17_5, kPtuName, FaultKind::PowerCycle, 2.0},
                    HeadFault{PanTiltModel::D46_17_5, kPtuName, FaultKind::CableOut, 3.0},
                    HeadFault{PanTiltModel::D46_17_5, kPtuName, FaultKind::Silence, 8.0},
                    HeadFault{PanTiltModel::D46_17_5, kRangefinderName, FaultKind::PowerCycle, 2.0},
                    HeadFault{PanTiltModel::D46_17_5, kRangefinderName, FaultKind::CableOut, 3.0},
                    HeadFault{PanTiltModel::CanOpen, kPtuName, FaultKind::MissedSteps, 2.0},
                    HeadFault{PanTiltModel::CanOpen, kPtuName, FaultKind::PowerCycle, 2.0},
                    HeadFault{PanTiltModel::CanOpen, kPtuName, FaultKind::PowerCycle, 2.0,
                              DriveMemory::Incremental},
                    HeadFault{PanTiltModel::CanOpen, kPtuName, FaultKind::Emergency, 2.0},
                    HeadFault{PanTiltModel::CanOpen, kCanName, FaultKind::InterfaceDown, 3.0},
                    HeadFault{PanTiltModel::CanOpen, kCanName, FaultKind::BusOff, 3.0}),
    [](const auto& fault) {
      const std::string_view unit = is_on_bus(fault.param.unit) ? "can_" : "ptu_";
      const bool forgets = fault.param.encoder == DriveMemory::Incremental;
      return std::string(unit).append(fault.param.device) + "_" + std::string(name_of(fault.param.kind)) +
             (forgets ? "_incremental" : "");
    });

}  // namespace
}  // namespace slamsensor::tools
