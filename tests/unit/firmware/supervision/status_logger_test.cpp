#include "firmware/status/status_text.hpp"
#include "tests/unit/firmware/supervision/sample_status.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slamsensor::firmware {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

struct StatusLoggerTest : testing::Test {
  std::vector<std::string> said() {
    std::vector<std::string> lines;
    for (const LogEntry& entry : logger.compare(status)) {
      lines.push_back(std::string(to_string(entry.level)) + ' ' + entry.text);
    }
    return lines;
  }

  /// Both devices ready, no fix yet, and all that said.
  void begin() {
    status.head.rangefinder.state = hal::DeviceState::Ready;
    status.head.rangefinder.problem = {};
    status.head.rangefinder.model = hal::FixedText<80>("LW20");
    status.state = SensorState::Scanning;
    said();
  }

  StatusLogger logger;
  SensorStatus status = fixed_status();
};

TEST_F(StatusLoggerTest, TheSameStatusSaysNothingTwice) {
  EXPECT_THAT(said(),
              ElementsAre("notice pan-tilt ready: PTU-46-17.5",
                          "warning rangefinder: no reply at 9600 baud; check cable",
                          "notice first fix: x=12.50 m y=-3.25 m heading=0.0 deg, 23 of 30 landmarks, 31.0 s "
                          "after start"));
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(StatusLoggerTest, ADeviceIsLostAndRecoversOnceEach) {
  begin();
  status.head.rangefinder.state = hal::DeviceState::Absent;
  status.head.rangefinder.problem = status.head.rangefinder.last_loss = ProblemText("unplugged");
  EXPECT_THAT(said(), ElementsAre("warning rangefinder lost: unplugged"));
  EXPECT_THAT(said(), IsEmpty());
  status.head.rangefinder.state = hal::DeviceState::Starting;
  EXPECT_THAT(said(), IsEmpty());
  status.head.rangefinder.problem = ProblemText("wrong device");
  EXPECT_THAT(said(), ElementsAre("warning rangefinder: wrong device"));
  status.head.rangefinder.state = hal::DeviceState::Ready;
  status.head.rangefinder.problem = {};
  status.head.rangefinder.last_recovery = std::chrono::milliseconds(1250);
  EXPECT_THAT(said(), ElementsAre("notice rangefinder recovered after 1.2 s"));
}

TEST_F(StatusLoggerTest, AShortLossIsToldWithItsReason) {
  begin();
  status.head.rangefinder.state = hal::DeviceState::Starting;
  status.head.rangefinder.last_loss = ProblemText("hung up");
  status.head.rangefinder.problem = ProblemText("is being started up");
  EXPECT_THAT(said(),
              ElementsAre("warning rangefinder lost: hung up", "warning rangefinder: is being started up"));
  status.head.rangefinder.state = hal::DeviceState::Ready;
  status.head.rangefinder.problem = {};
  status.head.rangefinder.recoveries = 1;
  status.head.rangefinder.last_recovery = std::chrono::milliseconds(400);
  EXPECT_THAT(said(), ElementsAre("notice rangefinder recovered after 0.4 s"));
  // Lost and back between two looks.
  status.head.rangefinder.last_loss = ProblemText("no reply");
  status.head.rangefinder.recoveries = 2;
  status.head.rangefinder.last_recovery = std::chrono::milliseconds(100);
  EXPECT_THAT(said(),
              ElementsAre("warning rangefinder lost: no reply", "notice rangefinder recovered after 0.1 s"));
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(StatusLoggerTest, AFixIsFoundLostAndFoundAgain) {
  begin();
  status.state = SensorState::Fixed;
  EXPECT_THAT(said(), ElementsAre(StartsWith("notice first fix: x=12.50")));
  status.report.fix.pose_W.x_m = 13.0;
  EXPECT_THAT(said(), IsEmpty());
  status.state = SensorState::Lost;
  status.report.fix.status = core::FixStatus::NoFix;
  status.report.fix.reason = core::FixReason::TooFewLandmarks;
  EXPECT_THAT(said(), ElementsAre("warning no fix: too few landmarks around, 30 landmarks seen"));
  status.report.fix.reason = core::FixReason::NoOverlap;
  EXPECT_THAT(said(), ElementsAre("warning no fix: nothing here looks like the map, 30 landmarks seen"));
  status.state = SensorState::Ambiguous;
  status.report.fix.status = core::FixStatus::Ambiguous;
  status.report.fix.reason = core::FixReason::Symmetric;
  EXPECT_THAT(said(),
              ElementsAre("warning ambiguous: another place of the map looks the same, 30 landmarks seen"));
  status.state = SensorState::Fixed;
  status.report.fix.status = core::FixStatus::Fix;
  status.report.fix.reason = core::FixReason::None;
  EXPECT_THAT(said(), ElementsAre(StartsWith("notice fix found again: x=13.00")));
}

TEST_F(StatusLoggerTest, AHeadThatMakesNoScansIsReportedOnceAMinute) {
  begin();
  status.head.failing = true;
  status.state = SensorState::Faulted;
  status.head.problem = ProblemText("pan-tilt unit: pan has not moved");
  EXPECT_THAT(said(), ElementsAre("warning no scan comes about: pan-tilt unit: pan has not moved"));
  status.head.problem = ProblemText("pan-tilt unit: pan has not moved, 2 times in a row");
  status.head.stamp += std::chrono::seconds(59);
  EXPECT_THAT(said(), IsEmpty());
  status.head.stamp += std::chrono::seconds(1);
  EXPECT_THAT(said(),
              ElementsAre("warning no scan comes about: pan-tilt unit: pan has not moved, 2 times in a row"));
  status.head.failing = false;
  status.head.problem = {};
  EXPECT_THAT(said(), ElementsAre("notice scans come about again"));
}

TEST_F(StatusLoggerTest, HoldsProblemsJumpsAndModesAreReported) {
  begin();
  status.head.held = true;
  status.head.problem = ProblemText("interlock open");
  EXPECT_THAT(said(), ElementsAre("notice scanning is held: interlock open"));
  status.head.held = false;
  status.head.problem = {};
  EXPECT_THAT(said(), ElementsAre("notice scanning goes on"));
  status.head.problem = ProblemText("tilt range is beyond the unit's limits");
  EXPECT_THAT(said(), ElementsAre("warning no scanning: tilt range is beyond the unit's limits"));
  status.report.fix.jumps = 1;
  EXPECT_THAT(said(), ElementsAre(StartsWith("warning the best hypothesis changed")));
  status.slam.frozen = true;
  status.recording = true;
  EXPECT_THAT(said(), ElementsAre("notice the map is frozen", "notice recording begins"));
}

}  // namespace
}  // namespace slamsensor::firmware
