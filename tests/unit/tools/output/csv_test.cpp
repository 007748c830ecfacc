#include "tools/output/result_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <limits>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr std::string_view kFixesHeading =
    "scan,status,reason,search_end,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,sigma_heading_rad,corr_x_y,corr_x_"
    "heading,"
    "corr_y_heading,error_xi,matches,landmarks_seen,landmarks_in_map,expected_false_alarms,weight_best,"
    "weight_runner_up,jumps,map,home,protection_radius_m,sigma_near_m,t_s,milliseconds\n";

FixRow fix_row() {
  FixRow row;
  row.scan = 12;
  row.t_s = 12.5;
  row.milliseconds = 3.25;
  core::Fix& fix = row.fix;
  fix.status = core::FixStatus::Fix;
  fix.reason = core::FixReason::None;
  fix.search_end = core::SearchEnd::Share;
  fix.pose_W = {1.5, -2.25, 0.5};
  fix.covariance << 0.04, 0.01, 0.0, 0.01, 0.25, -0.0005, 0.0, -0.0005, 1e-6;
  fix.error_xi = 4;
  fix.matches = 11;
  fix.landmarks_seen = 20;
  fix.landmarks_in_map = 45;
  fix.expected_false_alarms = 1.5e-7;
  fix.weight_best = 100;
  fix.weight_runner_up = 60;
  fix.jumps = 2;
  fix.map = fix.home = 1;
  fix.protection_radius_m = 1.25;
  fix.covariance_near.diagonal() << 0.0004, 0.0009, 1e-6;
  return row;
}

TEST(FixesCsv, GoldenFix) {
  const FixRow row = fix_row();
  EXPECT_EQ(
      format_fixes({&row, 1}),
      std::string(kFixesHeading) +
          "12,fix,none,share,1.500000,-2.250000,0.500000000,0.200000,0.500000,0.001000000,0.100000,0.000000,"
          "-1.000000,4,11,20,45,1.5e-07,100,60,2,1,1,1.250000,0.030000,12.5,3.250\n");
}

TEST(FixesCsv, GoldenNoFixHasEmptyPoseAndAllColumns) {
  FixRow row = fix_row();
  row.fix.status = core::FixStatus::NoFix;
  row.fix.reason = core::FixReason::TooFewLandmarks;
  row.fix.search_end = core::SearchEnd::NotStarted;
  const std::string text = format_fixes({&row, 1}, MeasuredTimes::Empty);
  EXPECT_EQ(text,
            std::string(kFixesHeading) +
                "12,no_fix,too_few_landmarks,not_started,,,,,,,,,,,11,20,45,1.5e-07,100,60,2,0,1,,,12.5,\n");
  const std::string line = text.substr(kFixesHeading.size());
  EXPECT_EQ(std::count(line.begin(), line.end(), ','),
            std::count(kFixesHeading.begin(), kFixesHeading.end(), ','));
}

TEST(FixesCsv, AmbiguousHasItsPose) {
  FixRow row = fix_row();
  row.fix.status = core::FixStatus::Ambiguous;
  EXPECT_NE(format_fixes({&row, 1}).find("12,ambiguous,none,share,1.500000"), std::string::npos);
}

TEST(FixesCsv, APoseInALocalMapComesWithThatMapsNumber) {
  FixRow row = fix_row();
  row.fix.status = core::FixStatus::NoFix;
  row.fix.reason = core::FixReason::LocalMap;
  row.fix.map = 4;
  const std::string text = format_fixes({&row, 1});
  EXPECT_NE(text.find("12,no_fix,local_map,share,1.500000"), std::string::npos) << text;
  EXPECT_NE(text.find(",100,60,2,4,1,1.250000,0.030000,12.5,"), std::string::npos) << text;
}

TEST(FixesCsv, OriginIsKnownExactly) {
  FixRow row = fix_row();
  row.fix.covariance.setZero();
  EXPECT_NE(format_fixes({&row, 1}).find(",0.000000,0.000000,0.000000000,0.000000,0.000000,0.000000,4,"),
            std::string::npos);
}

TEST(FixesCsv, ImpossibleVarianceIsEmpty) {
  FixRow row = fix_row();
  row.fix.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  row.fix.covariance(2, 2) = -1.0;
  EXPECT_NE(format_fixes({&row, 1}).find(",0.500000000,,0.500000,,,,,4,"), std::string::npos);
}

TEST(TrajectoryTum, Golden) {
  const std::vector<TimedPose> poses{{1.0, {0.0, -0.0, 0.0}},
                                     {1700000000.25, {1.2345678, -2.0, 0.5 * std::numbers::pi}},
                                     {3.0, {0.0, 0.0, -std::numbers::pi}}};
  EXPECT_EQ(format_trajectory(poses),
            "1 0.000000 0.000000 0.000000 0.000000000 0.000000000 0.000000000 1.000000000\n"
            "1700000000.25 1.234568 -2.000000 0.000000 0.000000000 0.000000000 0.707106781 0.707106781\n"
            "3 0.000000 0.000000 0.000000 0.000000000 0.000000000 -1.000000000 0.000000000\n");
}

TEST(TrajectoryTum, OnlyFixesAreInTheTrajectory) {
  std::vector<FixRow> rows(3, fix_row());
  rows[0].fix.status = core::FixStatus::NoFix;
  rows[1].fix.status = core::FixStatus::Ambiguous;
  const std::vector<TimedPose> poses = trajectory_of(rows);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].t, 12.5);
  EXPECT_EQ(poses[0].pose.y_m, -2.25);
}

TEST(TrajectoryTum, LeavesOutFixesOfAHomeMapThatWasGivenUp) {
  std::vector<FixRow> rows(3, fix_row());
  rows[2].fix.home = rows[2].fix.map = 2;
  rows[2].t_s = 14.5;
  const std::vector<TimedPose> poses = trajectory_of(rows);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].t, 14.5);
}

TEST(MapCsv, Golden) {
  const MapRow row{7, {1.25, -3.0}, 2, 9, -1, 56, 0.0625, 0.305};
  EXPECT_EQ(format_map({&row, 1}),
            "id,x_m,y_m,xi,sightings,first_scan,last_scan,sigma_m,diameter_m\n7,1.250000,-3.000000,2,9,-1,56,"
            "0.0625,0.305\n");
}

TEST(Csv, UnwritablePathIsReported) {
  const auto path = std::filesystem::path(testing::TempDir()) / "no such folder" / "x";
  EXPECT_FALSE(write_fixes(path, {}));
  EXPECT_FALSE(write_trajectory(path, {}));
  EXPECT_FALSE(write_map(path, {}));
}

}  // namespace
}  // namespace slamsensor::tools
