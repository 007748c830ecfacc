#include "tests/unit/tools/input/temp_folder.hpp"
#include "tools/input/text_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string error_of(std::string_view text) {
  const auto poses = parse_tum(text, "t.tum");
  return poses ? "" : poses.error().message;
}

TEST(Tum, SortsPosesByTimeAndTakesTheYaw) {
  const auto poses =
      parse_tum("# t x y z qx qy qz qw\r\n2 3.5 -4 1 0 0 0.70710678 0.70710678\n\n1 0 0 0 0 0 0 1\n", "t");
  ASSERT_TRUE(poses);
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ(poses->at(0).t, 1.0);
  EXPECT_EQ(poses->at(0).pose.heading_rad, 0.0);
  EXPECT_EQ(poses->at(1).t, 2.0);
  EXPECT_EQ(poses->at(1).pose.x_m, 3.5);
  EXPECT_EQ(poses->at(1).pose.y_m, -4.0);
  EXPECT_NEAR(poses->at(1).pose.heading_rad, std::numbers::pi / 2, 1e-9);
}

TEST(Tum, YawIsIndependentOfRollAndPitch) {
  for (double yaw = -3.0; yaw <= 3.0; yaw += 0.5) {
    // q = q_z(yaw) q_y(0.4) q_x(-0.3)
    const double cz = std::cos(yaw / 2), sz = std::sin(yaw / 2);
    const double cy = std::cos(0.2), sy = std::sin(0.2), cx = std::cos(-0.15), sx = std::sin(-0.15);
    const double q[4] = {cz * cy * sx - sz * sy * cx, cz * sy * cx + sz * cy * sx,
                         sz * cy * cx - cz * sy * sx, cz * cy * cx + sz * sy * sx};
    std::string line = "0 0 0 0";
    for (const double part : q) {
      line += " " + std::to_string(part);
    }
    const auto poses = parse_tum(line, "t");
    ASSERT_TRUE(poses) << line;
    EXPECT_NEAR(poses->front().pose.heading_rad, yaw, 1e-5);
  }
}

TEST(Tum, AQuaternionSlightlyOffUnitLengthIsNormalised) {
  const auto poses = parse_tum("0 0 0 0 0 0 0.71 0.71", "t");
  ASSERT_TRUE(poses);
  EXPECT_NEAR(poses->front().pose.heading_rad, std::numbers::pi / 2, 1e-12);
}

TEST(Tum, SaysLineAndReasonOfARefusal) {
  EXPECT_THAT(error_of("1 2 3\n"), AllOf(HasSubstr("t.tum:1"), HasSubstr("z is ''")));
  EXPECT_THAT(error_of("\n1 0 0 0 0 0 0 1 9\n"), AllOf(HasSubstr("t.tum:2"), HasSubstr("'9'")));
  EXPECT_THAT(error_of("1 nan 0 0 0 0 0 1\n"), HasSubstr("x is 'nan'"));
  EXPECT_THAT(error_of("1 0 inf 0 0 0 0 1\n"), HasSubstr("y is 'inf'"));
  EXPECT_THAT(error_of("1,0,0,0,0,0,0,1\n"), HasSubstr("t is '1,0"));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 0\n"), HasSubstr("length 0"));
  EXPECT_THAT(error_of("1 0 0 0 1 0 0 1\n"), HasSubstr("length 1.41"));
  EXPECT_THAT(error_of("1 0 0 0 0 0.70710678118654752 0 0.70710678118654752\n"), HasSubstr("no heading"));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n1.0 5 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("t.tum:3"), HasSubstr("line 1")));
}

TEST(Tum, AFileWithoutPosesIsAnEmptyTrajectory) {
  const TempFolder folder;
  EXPECT_TRUE(read_tum(folder.write("empty.tum", "# nothing\n")).value().empty());
  EXPECT_THAT(read_tum(folder.path() / "none.tum").error().message, HasSubstr("does not exist"));
  EXPECT_THAT(read_tum(folder.path()).error().message, HasSubstr("not a regular file"));
}

}  // namespace
}  // namespace slamsensor::tools
