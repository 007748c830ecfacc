#include "core/detection/levelling.hpp"

#include "core/config.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace slamsensor::core {
namespace {

Eigen::Vector3d direction(const Reading& reading) {
  return {std::cos(reading.tilt_rad) * std::cos(reading.pan_rad),
          std::cos(reading.tilt_rad) * std::sin(reading.pan_rad), std::sin(reading.tilt_rad)};
}

const Attitude kAttitudes[] = {
    {0.0, 0.0}, {5.0 * kDegree, 0.0}, {0.0, -5.0 * kDegree}, {3.0 * kDegree, 4.0 * kDegree}, {-0.4, 0.7}};

TEST(Levelling, UprightChangesNothing) {
  const Levelling level{Attitude{}};
  for (double pan_deg = -179.0; pan_deg < 180.0; pan_deg += 7.0) {
    const Reading got = level({pan_deg * kDegree, -0.2, 12.0});
    EXPECT_NEAR(got.pan_rad, pan_deg * kDegree, 1e-12);
    EXPECT_NEAR(got.tilt_rad, -0.2, 1e-12);
    EXPECT_EQ(got.range_m, 12.0);
  }
}

// The convention, by hand: REP 103.
TEST(Levelling, PositiveRollLiftsTheLeftSide) {
  const Levelling level{Attitude{5.0 * kDegree, 0.0}};
  EXPECT_NEAR(level({90.0 * kDegree, 0.0, 1.0}).tilt_rad, 5.0 * kDegree, 1e-12);
  EXPECT_NEAR(level({-90.0 * kDegree, 0.0, 1.0}).tilt_rad, -5.0 * kDegree, 1e-12);
  EXPECT_NEAR(level({0.0, 0.0, 1.0}).tilt_rad, 0.0, 1e-12);
}

TEST(Levelling, PositivePitchLowersTheFront) {
  const Levelling level{Attitude{0.0, 5.0 * kDegree}};
  EXPECT_NEAR(level({0.0, 0.0, 1.0}).tilt_rad, -5.0 * kDegree, 1e-12);
  EXPECT_NEAR(level({180.0 * kDegree, 0.0, 1.0}).tilt_rad, 5.0 * kDegree, 1e-12);
  EXPECT_NEAR(level({90.0 * kDegree, 0.0, 1.0}).tilt_rad, 0.0, 1e-12);
}

TEST(Levelling, ForwardKeepsItsBearingWhateverTheAttitude) {
  for (const Attitude& attitude : kAttitudes) {
    EXPECT_NEAR(Levelling(attitude)({0.0, 0.0, 1.0}).pan_rad, 0.0, 1e-12);
  }
}

TEST(Levelling, NoReturnKeepsItsDirectionTurned) {
  const Levelling level{Attitude{0.1, -0.05}};
  const Reading with = level({0.7, 0.1, 30.0});
  const Reading without = level({0.7, 0.1, Reading::kNoReturn});
  EXPECT_FALSE(without.has_return());
  EXPECT_EQ(without.range_m, Reading::kNoReturn);
  EXPECT_EQ(without.pan_rad, with.pan_rad);
  EXPECT_EQ(without.tilt_rad, with.tilt_rad);
}

TEST(Levelling, AnglesBetweenShotsStayAsTheyAre) {
  const Reading a{0.3, -0.2, 1.0};
  const Reading b{2.1, 0.4, 1.0};
  for (const Attitude& attitude : kAttitudes) {
    const Levelling level(attitude);
    EXPECT_NEAR(direction(level(a)).dot(direction(level(b))), direction(a).dot(direction(b)), 1e-12);
  }
}

TEST(Levelling, ReadingWithoutAnAngleIsStillRefusable) {
  const Levelling level{Attitude{0.1, 0.1}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(level({nan, 0.0, 1.0}).pan_rad));
  EXPECT_TRUE(std::isnan(level({0.0, nan, 1.0}).tilt_rad));
}

TEST(Levelling, UpBecomesVertical) {
  for (const Attitude& attitude : kAttitudes) {
    const Eigen::Vector3d up = up_L(attitude);
    const Reading shot{std::atan2(up.y(), up.x()), std::atan2(up.z(), up.head<2>().norm()), 1.0};
    EXPECT_NEAR(Levelling(attitude)(shot).tilt_rad, 0.5 * std::numbers::pi, 1e-7);
  }
}

TEST(Levelling, AttitudeOfUpIsTheInverse) {
  for (const Attitude& attitude : kAttitudes) {
    const Attitude got = attitude_of_up(9.81 * up_L(attitude));
    EXPECT_NEAR(got.roll_rad, attitude.roll_rad, 1e-12);
    EXPECT_NEAR(got.pitch_rad, attitude.pitch_rad, 1e-12);
  }
}

TEST(Levelling, LeanIsTheAngleToTheVertical) {
  EXPECT_NEAR(lean_rad({5.0 * kDegree, 0.0}), 5.0 * kDegree, 1e-12);
  EXPECT_NEAR(lean_rad({0.0, -5.0 * kDegree}), 5.0 * kDegree, 1e-12);
  EXPECT_NEAR(lean_rad({3.0 * kDegree, 4.0 * kDegree}), 5.0 * kDegree, 1e-4);
  EXPECT_NEAR(angle_between_rad({0.1, 0.0}, {-0.1, 0.0}), 0.2, 1e-12);
  EXPECT_EQ(angle_between_rad({0.2, 0.3}, {0.2, 0.3}), 0.0);
}

TEST(Levelling, OffsetOfTheInclinometerIsTakenOut) {
  const Attitude offset{2.0 * kDegree, -3.0 * kDegree};
  const Attitude upright = without_offset(offset, offset);
  EXPECT_NEAR(upright.roll_rad, 0.0, 1e-12);
  EXPECT_NEAR(upright.pitch_rad, 0.0, 1e-12);
  // The inclinometer's attitude in space, made of the sensor's and its own on it, tells the sensor's again.
  for (const Attitude& attitude : kAttitudes) {
    const Eigen::Matrix3d R_L_I = (Eigen::AngleAxisd(offset.pitch_rad, Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(offset.roll_rad, Eigen::Vector3d::UnitX()))
                                      .toRotationMatrix();
    const Attitude told_I = attitude_of_up(R_L_I.transpose() * up_L(attitude));
    const Attitude got = without_offset(told_I, offset);
    EXPECT_NEAR(got.roll_rad, attitude.roll_rad, 1e-12);
    EXPECT_NEAR(got.pitch_rad, attitude.pitch_rad, 1e-12);
  }
}

}  // namespace
}  // namespace slamsensor::core
