// Which map's frame the pose in slamsensor.pose_t is in.
#include "tests/unit/firmware/lcm/sample_reports.hpp"

#include <gtest/gtest.h>

namespace slamsensor::firmware {
namespace {

using tests::sample_report;

// The one output in which a pose in a local map is told; the map's number says that it is no fix of the home
// map.
TEST(LcmPose, CarriesThePoseInALocalMapWithItsNumber) {
  std::array<std::uint8_t, 1400> out{};
  FixReport report = sample_report();
  report.fix.status = core::FixStatus::NoFix;
  report.fix.reason = core::FixReason::LocalMap;
  report.fix.map = 5;
  const auto message = decode_lcm<PoseMessage>({out.data(), encode_pose(report, out)});
  ASSERT_TRUE(message);
  EXPECT_EQ(message->status, 0);
  EXPECT_EQ(message->reason, 10);
  EXPECT_EQ(message->map, 5);
  EXPECT_EQ(message->home, 3);
  EXPECT_EQ(message->x_m, 12.5);
  EXPECT_EQ(message->protection_radius_m, 0.9);
  EXPECT_EQ(encode_bot_core_pose(report, out), 0U);
}

TEST(LcmPose, NamesNoMapWithoutAPose) {
  std::array<std::uint8_t, 1400> out{};
  FixReport report = sample_report();
  report.fix.status = core::FixStatus::NoFix;
  for (int reason = 1; reason <= static_cast<int>(core::FixReason::NoScan); ++reason) {
    report.fix.reason = static_cast<core::FixReason>(reason);
    const auto message = decode_lcm<PoseMessage>({out.data(), encode_pose(report, out)});
    ASSERT_TRUE(message) << reason;
    EXPECT_EQ(message->reason, reason);
    EXPECT_EQ(message->map != 0, report.fix.reason == core::FixReason::LocalMap) << reason;
  }
}

}  // namespace
}  // namespace slamsensor::firmware
