#include "hal/inclination/iio_accelerometer.hpp"

#include "tests/support/fake_iio.hpp"
#include "tests/support/no_alloc_scope.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <utility>

namespace slamsensor::tests {
namespace {

using hal::DeviceState;

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(IioNumbers, AreReadStrictly) {
  EXPECT_EQ(hal::parse_iio_number("-17\n"), -17.0);
  EXPECT_EQ(hal::parse_iio_number(" 0.038307 "), 0.038307);
  for (const char* text : {"", "\n", "12 13", "0x10", "nan", "inf", "1e999", "12a", "--1"}) {
    EXPECT_FALSE(hal::parse_iio_number(text)) << text;
  }
}

TEST(IioNumbers, MountMatrixIsARotation) {
  EXPECT_TRUE(hal::parse_mount_matrix("1, 0, 0; 0, 1, 0; 0, 0, 1\n"));
  const auto turned = hal::parse_mount_matrix("0, -1, 0; 1, 0, 0; 0, 0, 1");
  ASSERT_TRUE(turned);
  EXPECT_EQ((*turned)[1], -1.0);
  for (const char* text :
       {"", "1, 0, 0", "1, 0, 0; 0, 1, 0; 0, 0", "1, 0, 0; 0, 1, 0; 0, 0, 1; 5", "1, 0, 0; 0, 1, 0; 0, 0, x",
        "2, 0, 0; 0, 1, 0; 0, 0, 1", "1, 0, 0; 0, 1, 0; 0, 0, -1", "0, 0, 0; 0, 0, 0; 0, 0, 0",
        "1, 0, 0; 1, 0, 0; 0, 0, 1"}) {
    EXPECT_FALSE(hal::parse_mount_matrix(text)) << text;
  }
}

class Accelerometer : public testing::Test {
 protected:
  void open(const std::string& device = "adxl345") {
    hal::IioConfig config;
    config.root = iio.root().string();
    config.device = device;
    auto made = hal::IioAccelerometer::create(config);
    ASSERT_TRUE(made) << made.error().message;
    driver = std::move(*made);
  }

  void run(int milliseconds) {
    for (int i = 0; i < milliseconds; i += 10) {
      now += std::chrono::milliseconds(10);
      driver->step(now);
    }
  }

  std::optional<hal::Inclination> measured() {
    run(1200);
    return driver->take();
  }

  FakeIio iio;
  std::unique_ptr<hal::IioAccelerometer> driver;
  hal::Stamp now = std::chrono::seconds(1);
};

TEST_F(Accelerometer, AtRestItsAccelerationPointsUp) {
  open();
  iio.set_raw(0, 0, 256);
  const auto level = measured();
  ASSERT_TRUE(level) << driver->problem();
  EXPECT_NEAR(level->roll_rad, 0.0, 1e-9);
  EXPECT_NEAR(level->pitch_rad, 0.0, 1e-9);
  EXPECT_EQ(driver->model().view(), "adxl345");
  iio.set_raw(0, 22, 255);  // the left side points up a little
  EXPECT_NEAR(measured()->roll_rad, 4.93 * kDegree, 1e-3);
  iio.set_raw(22, 0, 255);  // the front points up a little
  EXPECT_NEAR(measured()->pitch_rad, -4.93 * kDegree, 1e-3);
}

TEST_F(Accelerometer, IsFoundByFolderNameNameLabelOrPath) {
  iio.write("label", "carrier-tilt\n");
  for (const std::string& device : {std::string("iio:device1"), std::string("adxl345"),
                                    std::string("carrier-tilt"), iio.folder().string()}) {
    open(device);
    EXPECT_TRUE(measured()) << device << ": " << driver->problem();
  }
}

TEST_F(Accelerometer, OffsetsScalesAndMountMatrixCount) {
  iio.write("in_accel_offset", "100\n");
  iio.write("in_accel_z_scale", "-0.038307\n");
  iio.write("in_accel_mount_matrix", "0, -1, 0; 1, 0, 0; 0, 0, 1\n");
  iio.set_raw(-100, -122, -355);  // (0, -22, -255) steps, z upside down, turned by a quarter: (22, 0, 255)
  open();
  const auto got = measured();
  ASSERT_TRUE(got) << driver->problem();
  EXPECT_NEAR(got->pitch_rad, -4.93 * kDegree, 1e-3);
  EXPECT_NEAR(got->roll_rad, 0.0, 1e-9);
}

TEST_F(Accelerometer, RefusesWhatIsNotGravityAlone) {
  open();
  ASSERT_TRUE(measured());
  iio.set_raw(0, 60, 262);  // 5 % too much
  EXPECT_FALSE(measured());
  EXPECT_EQ(driver->state(), DeviceState::Faulted);
  EXPECT_NE(
      driver->problem().find("accelerometer adxl345: does not measure gravity alone; let the carrier stand"),
      std::string_view::npos)
      << driver->problem();
  iio.set_raw(0, 0, 256);
  EXPECT_TRUE(measured());
  EXPECT_EQ(driver->state(), DeviceState::Ready);
}

TEST_F(Accelerometer, AbsentDeviceIsReportedAndFoundLater) {
  open("lis3dh");
  EXPECT_FALSE(measured());
  EXPECT_EQ(driver->state(), DeviceState::Absent);
  EXPECT_NE(driver->problem().find("accelerometer lis3dh: is not there"), std::string_view::npos)
      << driver->problem();
  iio.write("name", "lis3dh\n");
  run(1500);
  EXPECT_TRUE(measured()) << driver->problem();
}

TEST_F(Accelerometer, BrokenFilesAreNamed) {
  iio.write("in_accel_scale", "much\n");
  open();
  EXPECT_FALSE(measured());
  EXPECT_NE(driver->problem().find("scale"), std::string_view::npos) << driver->problem();
  iio.write("in_accel_scale", "0.038307\n");
  iio.write("in_mount_matrix", "1, 0, 0; 0, 1, 0; 0, 0, 7\n");
  run(1500);
  EXPECT_NE(driver->problem().find("mount matrix"), std::string_view::npos) << driver->problem();
  iio.remove("in_mount_matrix");
  iio.write("in_accel_y_raw", std::string(300, '9'));
  run(2500);
  EXPECT_FALSE(driver->take());
  iio.write("in_accel_y_raw", "-\n");
  iio.remove("in_accel_z_raw");
  run(2500);
  EXPECT_NE(driver->problem().find("in_accel_{x,y,z}_raw"), std::string_view::npos) << driver->problem();
  iio.set_raw(0, 0, 256);
  run(1500);
  EXPECT_TRUE(measured()) << driver->problem();
}

TEST_F(Accelerometer, RefusesADeviceWithoutAName) {
  EXPECT_FALSE(hal::IioAccelerometer::create({.device = ""}));
}

TEST_F(Accelerometer, TakesNoMemory) {
  open();
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "the heap cannot be watched here";
  }
  const NoAllocScope scope;
  run(3000);
  const std::uint64_t calls = scope.heap_calls();
  EXPECT_EQ(calls, 0U);
}

}  // namespace
}  // namespace slamsensor::tests
