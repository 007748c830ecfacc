#include "firmware/control/status_report.hpp"
#include "tests/unit/firmware/supervision/sample_status.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slamsensor::firmware {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST(FixJson, HasPoseAndErrorsOfAFix) {
  const std::string json = fix_json(fixed_status());
  EXPECT_THAT(json, HasSubstr(R"("status":"fix","reason":"none","search_end":"complete","scan":41)"));
  EXPECT_THAT(json, HasSubstr(R"("x_m":12.5,"y_m":-3.25,"heading_rad":0.0)"));
  EXPECT_THAT(
      json,
      HasSubstr(
          R"("covariance":[0.04,0.0,0.0,0.0,0.01,0.0,0.0,0.0,0.0001],"sigma_m":0.2,"sigma_heading_rad":0.01,)"));
  EXPECT_THAT(json, HasSubstr(R"("home":2,"map":2,"x_m")"));
  EXPECT_THAT(
      json,
      HasSubstr(
          R"("protection_radius_m":1.05,"covariance_near":[0.0004,0.0,0.0,0.0,0.0009,0.0,0.0,0.0,0.0001],)"
          R"("sigma_near_m":0.03,"error_xi":0)"));
  EXPECT_THAT(json, HasSubstr(R"("matches":23,"landmarks_seen":30,"landmarks_in_map":512)"));
  EXPECT_THAT(json, HasSubstr(R"("home_replaced":false)"));
}

TEST(FixJson, HasNoPoseWithoutAFix) {
  SensorStatus status = fixed_status();
  status.report.fix.status = core::FixStatus::NoFix;
  const std::string json = fix_json(status);
  EXPECT_THAT(json,
              HasSubstr(R"("x_m":null,"y_m":null,"heading_rad":null,"heading_deg":null,"covariance":null)"));
  EXPECT_THAT(json, Not(HasSubstr("12.5")));
}

// A script that reads x_m without looking at the status must not take another frame's pose for one in the
// home map.
TEST(FixJson, APoseInALocalMapNamesThatMap) {
  SensorStatus status = fixed_status();
  status.report.fix.status = core::FixStatus::NoFix;
  status.report.fix.reason = core::FixReason::LocalMap;
  status.report.fix.map = 4;
  EXPECT_THAT(fix_json(status), HasSubstr(R"("status":"no_fix","reason":"local_map")"));
  EXPECT_THAT(fix_json(status), HasSubstr(R"("home":2,"map":4,"x_m":12.5)"));
  EXPECT_THAT(fix_text(status), Contains("map:            4, local: its place is not known yet"));
}

TEST(FixText, ReportsMapAndProtectionRadius) {
  const auto lines = fix_text(fixed_status());
  EXPECT_THAT(lines, Contains("map:            2, home"));
  EXPECT_THAT(lines, Contains("1 sigma near:   0.030 m, 0.57 deg"));
  EXPECT_THAT(lines, Contains("protection:     1.050 m, exceeded with at most the configured risk"));
}

TEST(StatusText, ReportsLocalMaps) {
  SensorStatus status = fixed_status();
  EXPECT_THAT(status_text(status), Not(Contains(HasSubstr("local map"))));
  status.slam.local_maps = 1;
  status.slam.local_landmarks = 17;
  EXPECT_THAT(status_text(status),
              Contains(HasSubstr("512 landmarks, 1 local map with 17 landmarks, saved")));
  EXPECT_THAT(status_json(status), HasSubstr(R"("local_maps":1,"local_landmarks":17)"));
}

TEST(StatusText, BeforeTheFirstScanItSaysSo) {
  SensorStatus status = fixed_status();
  status.state = SensorState::Scanning;
  status.report.fix = {};
  EXPECT_THAT(status_text(status), Contains("fix:            no fix: no scan yet"));
  EXPECT_THAT(fix_json(status), HasSubstr(R"("status":"no_fix","reason":"no_scan")"));
}

TEST(StatusText, AReplacedHomeMapSaysThatTheDatumDoesNotHoldAndTheWayOut) {
  SensorStatus status = fixed_status();
  EXPECT_THAT(status_text(status), Not(Contains(HasSubstr("datum"))));
  status.report.fix.is_home_replaced = true;
  status.report.fix.home = 4;
  EXPECT_THAT(status_text(status),
              Contains(AllOf(HasSubstr("datum:"), HasSubstr("replaced by map 4"), HasSubstr("map reset"))));
}

TEST(StatusJson, ShowsNeverAsNull) {
  SensorStatus status = fixed_status();
  status.map_saved_ago = hal::kNever;
  status.report.time_to_first_fix.reset();
  const std::string json = status_json(status);
  EXPECT_THAT(json, HasSubstr(R"("saved_ago_s":null)"));
  EXPECT_THAT(json, HasSubstr(R"("time_to_first_fix_s":null)"));
  EXPECT_THAT(
      json, HasSubstr(R"("rangefinder":{"state":"absent","problem":"no reply at 9600 baud; check cable",)"));
  EXPECT_THAT(json, HasSubstr(R"("counters":{"pan_tilt":{"replies_lost":3},"rangefinder":{},)"));
}

TEST(StatusText, IsForPeople) {
  const auto lines = status_text(fixed_status());
  EXPECT_THAT(lines, Contains("state:          fixed"));
  EXPECT_THAT(lines, Contains("fix:            x=12.50 m y=-3.25 m heading=0.0 deg, 23 of 30 landmarks"));
  EXPECT_THAT(lines, Contains("map:            default, 512 landmarks, saved 12.0 s ago"));
  EXPECT_THAT(lines,
              Contains("pan-tilt:       ready, PTU-46-17.5; recovered 2 times, the last within 350.00 ms"));
  EXPECT_THAT(lines, Contains("rangefinder:    absent: no reply at 9600 baud; check cable"));
}

TEST(StatusText, ADeviceSaysWhyItWasLostLast) {
  SensorStatus status = fixed_status();
  status.head.pan_tilt.last_loss = ProblemText("hung up");
  status.head.rangefinder.last_loss = status.head.rangefinder.problem;
  EXPECT_THAT(devices_text(status),
              Contains(HasSubstr("recovered 2 times, the last within 350.00 ms; last lost: hung up")));
  EXPECT_THAT(devices_text(status), Contains("rangefinder:    absent: no reply at 9600 baud; check cable"));
  EXPECT_THAT(devices_json(status), HasSubstr(R"("last_loss":"hung up")"));
}

TEST(StatusText, MapSaysWhatWouldBeLost) {
  SensorStatus status = fixed_status();
  status.map_unsaved = true;
  EXPECT_THAT(status_text(status),
              Contains(HasSubstr("512 landmarks, changed since it was saved 12.0 s ago")));
  status.map_saved_ago = hal::kNever;
  EXPECT_THAT(status_text(status), Contains(HasSubstr("not saved yet")));
}

TEST(CountersText, NamesStationAndCounter) {
  EXPECT_THAT(counters_text(fixed_status()), testing::ElementsAre("pan_tilt.replies_lost 3"));
}

}  // namespace
}  // namespace slamsensor::firmware
