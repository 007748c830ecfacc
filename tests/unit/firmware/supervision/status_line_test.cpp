#include "firmware/status/status_text.hpp"
#include "firmware/supervision/log.hpp"
#include "tests/unit/firmware/supervision/sample_status.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::firmware {
namespace {

TEST(StatusLine, ReportsFixMapAndDevices) {
  EXPECT_EQ(
      status_line(fixed_status()),
      "fixed x=12.50 m y=-3.25 m heading=0.0 deg, 23 of 30 landmarks, map 'default' 512 landmarks; pan-tilt "
      "ready; rangefinder: no reply at 9600 baud; check cable");
}

TEST(StatusLine, SaysWhyThereIsNone) {
  SensorStatus status = fixed_status();
  status.state = SensorState::Lost;
  status.report.fix.status = core::FixStatus::NoFix;
  status.report.fix.reason = core::FixReason::NoOverlap;
  status.slam.frozen = true;
  status.head.rangefinder = {};
  status.head.problem = ProblemText("interlock open");
  EXPECT_EQ(status_line(status),
            "lost: nothing here looks like the map, 30 landmarks seen, map 'default' 512 landmarks (frozen); "
            "pan-tilt "
            "ready; rangefinder absent; interlock open");
}

TEST(StatusLine, BeforeTheFirstScanThereIsNothingToSayOfAFix) {
  EXPECT_EQ(status_line(SensorStatus{}), "starting, map '' 0 landmarks; pan-tilt absent; rangefinder absent");
}

TEST(StatusLine, AfterAnotherMapWasLoadedThereIsNoScanYet) {
  SensorStatus status = fixed_status();
  status.state = SensorState::Scanning;
  status.report.fix = {};
  EXPECT_TRUE(status_line(status).starts_with("scanning, no fix: no scan yet, map 'default'"))
      << status_line(status);
}

TEST(StatusLine, AFaultedSensorMayStillHaveItsFix) {
  SensorStatus status = fixed_status();
  status.state = SensorState::Faulted;
  EXPECT_TRUE(status_line(status).starts_with("faulted, x=12.50 m"));
}

TEST(DecimalText, HasNoMinusZeroAndNoLocale) {
  EXPECT_EQ(decimal_text(-0.001, 2), "0.00");
  EXPECT_EQ(decimal_text(-0.005001, 2), "-0.01");
  EXPECT_EQ(decimal_text(1234567.891, 1), "1234567.9");
  EXPECT_EQ(decimal_text(std::nan(""), 1), "unknown");
}

}  // namespace
}  // namespace slamsensor::firmware
