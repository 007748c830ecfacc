#include "firmware/scan/scan_plan.hpp"

#include "core/config.hpp"

#include <gtest/gtest.h>

namespace slamsensor::firmware {
namespace {

using core::kDegree;
constexpr double kStep_rad = kPaperStep_rad;

hal::PanTiltInfo paper_unit() {
  hal::PanTiltInfo unit;
  const hal::AxisDynamics dynamics{1000 * kStep_rad, 2000 * kStep_rad};
  unit.pan = {-3090 * kStep_rad, 3090 * kStep_rad, kStep_rad, 31 * kStep_rad, 2902 * kStep_rad, dynamics};
  unit.tilt = {-907 * kStep_rad, 604 * kStep_rad, kStep_rad, 31 * kStep_rad, 2902 * kStep_rad, dynamics};
  return unit;
}

PlanLimit refusal(const ScanConfig& config, const hal::PanTiltInfo& unit = paper_unit()) {
  const auto plan = plan_scan(config, unit, 1000.0);
  EXPECT_FALSE(plan.has_value());
  return plan ? PlanLimit::PanRange : plan.error().limit_hit;
}

TEST(ScanPlan, ExperimentsOneAndTwo) {
  const auto plan = plan_scan({}, paper_unit(), 1000.0);
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->lines, 51U);
  EXPECT_NEAR(plan->sweep_s, 5.0, 1e-9);
  EXPECT_NEAR(plan->tilt_rad(0) / kDegree, -18.0, 1e-9);
  EXPECT_NEAR(plan->tilt_rad(50) / kDegree, 7.71, 0.005);
  EXPECT_FALSE(plan->clipped.any());
}

TEST(ScanPlan, ExperimentsThreeAndFourFromRoundedDegrees) {
  ScanConfig config;
  config.pan_min_rad = -128.57 * kDegree;
  config.pan_max_rad = 128.57 * kDegree;
  config.tilt_min_rad = -17.5 * kDegree;
  config.tilt_max_rad = 8.23 * kDegree;
  config.tilt_step_rad = 1.03 * kDegree;
  const auto plan = plan_scan(config, paper_unit(), 1000.0);
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->lines, 26U);
  EXPECT_NEAR(plan->tilt_rad(0), -340 * kStep_rad, 1e-12);
  EXPECT_NEAR(plan->tilt_rad(25), 160 * kStep_rad, 1e-12);
  EXPECT_NEAR(plan->pan_max_rad, 2500 * kStep_rad, 1e-12);
  EXPECT_FALSE(plan->clipped.any());
}

TEST(ScanPlan, WhatTheUnitCannotReachIsCutAndSaid) {
  ScanConfig config;
  config.pan_min_rad = -175.0 * kDegree;
  config.tilt_max_rad = 60.0 * kDegree;
  config.pan_speed_radps = 400.0 * kDegree;
  config.calibration_tilt_rad = 40.0 * kDegree;
  hal::PanTiltInfo unit = paper_unit();
  unit.pan.min_rad -= 0.4 * kStep_rad;  // no whole position
  const auto plan = plan_scan(config, unit, 1000.0);
  ASSERT_TRUE(plan.has_value());
  EXPECT_NEAR(plan->pan_min_rad, -3090 * kStep_rad, 1e-12);
  EXPECT_NEAR(plan->clipped.pan_min_rad / kDegree, 175.0 - 158.914, 0.03);
  EXPECT_EQ(plan->clipped.pan_max_rad, 0.0);
  EXPECT_LE(plan->tilt_rad(plan->lines - 1), 604 * kStep_rad + 1e-12);
  EXPECT_NEAR(plan->clipped.tilt_max_rad / kDegree, 60.0 - 31.06, 0.03);
  EXPECT_NEAR(plan->clipped.pan_speed_radps / kDegree, 400.0 - 149.2, 0.1);
  EXPECT_NEAR(plan->calibration_tilt_rad, 604 * kStep_rad, 1e-12);
  EXPECT_TRUE(plan->clipped.any());
}

TEST(ScanPlan, OneLineIsAScan) {
  ScanConfig config;
  config.tilt_max_rad = config.tilt_min_rad;
  const auto plan = plan_scan(config, paper_unit(), 1000.0);
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->lines, 1U);
}

TEST(ScanPlan, RefusalsNameTheLimit) {
  ScanConfig config;
  config.pan_min_rad = 170.0 * kDegree;
  config.pan_max_rad = 175.0 * kDegree;
  EXPECT_EQ(refusal(config), PlanLimit::PanRange);
  config = {};
  config.tilt_min_rad = -80.0 * kDegree;
  config.tilt_max_rad = -70.0 * kDegree;
  EXPECT_EQ(refusal(config), PlanLimit::TiltRange);
  const auto plan = plan_scan(config, paper_unit(), 1000.0);
  EXPECT_NE(to_text(plan.error()).find("tilt limits"), std::string::npos);
  EXPECT_NE(to_text(plan.error()).find("-46.6"), std::string::npos) << to_text(plan.error());
  config = {};
  config.tilt_step_rad = 0.4 * kStep_rad;
  EXPECT_EQ(refusal(config), PlanLimit::TiltStep);
  config = {};
  config.readings_per_line_max = 4000;
  EXPECT_EQ(refusal(config), PlanLimit::ReadingsPerLine);
}

TEST(ScanPlan, AUnitThatReportsNothingIsRefused) {
  hal::PanTiltInfo unit = paper_unit();
  unit.pan.resolution_rad = 0.0;
  EXPECT_EQ(refusal({}, unit), PlanLimit::PanResolution);
  unit = paper_unit();
  unit.tilt.resolution_rad = 0.0;
  EXPECT_EQ(refusal({}, unit), PlanLimit::TiltResolution);
  unit = paper_unit();
  unit.pan.speed_max_radps = 0.0;
  EXPECT_EQ(refusal({}, unit), PlanLimit::PanSpeed);
  unit = paper_unit();
  unit.tilt.speed_max_radps = 0.0;
  EXPECT_EQ(refusal({}, unit), PlanLimit::TiltSpeed);
  unit = paper_unit();
  unit.tilt.resolution_rad = 1e-6;
  ScanConfig config;
  config.tilt_step_rad = 1e-5;
  EXPECT_EQ(refusal(config, unit), PlanLimit::ScanlineCount);
}

}  // namespace
}  // namespace slamsensor::firmware
