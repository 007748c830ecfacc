#include "firmware/status/sensor_tracker.hpp"
#include "tests/support/fake_head.hpp"

#include <gtest/gtest.h>

namespace slamsensor::firmware {
namespace {

using hal::DeviceState;
using std::chrono::seconds;

DeviceStatus status_of(const DeviceWatch& watch) {
  const tests::FakePanTilt device{tests::FakePanTiltConfig{}};
  DeviceStatus status;
  watch.report(device, status);
  return status;
}

TEST(DeviceWatch, AStartIsNoRecovery) {
  DeviceWatch watch;
  watch.step(DeviceState::Absent, "", seconds(1));
  watch.step(DeviceState::Starting, "", seconds(2));
  watch.step(DeviceState::Ready, "", seconds(3));
  EXPECT_EQ(status_of(watch).recoveries, 0U);
  EXPECT_EQ(status_of(watch).state, DeviceState::Ready);
}

TEST(DeviceWatch, ARecoveryIsTimedFromTheLoss) {
  DeviceWatch watch;
  watch.step(DeviceState::Ready, "", seconds(3));
  watch.step(DeviceState::Absent, "", seconds(10));
  watch.step(DeviceState::Starting, "", seconds(11));
  watch.step(DeviceState::Faulted, "", seconds(12));
  EXPECT_EQ(status_of(watch).recoveries, 0U);
  watch.step(DeviceState::Ready, "", seconds(14));
  EXPECT_EQ(status_of(watch).recoveries, 1U);
  EXPECT_EQ(status_of(watch).last_recovery, seconds(4));
  watch.step(DeviceState::Ready, "", seconds(15));
  watch.step(DeviceState::Starting, "", seconds(20));
  watch.step(DeviceState::Ready, "", seconds(21));
  EXPECT_EQ(status_of(watch).recoveries, 2U);
  EXPECT_EQ(status_of(watch).last_recovery, seconds(1));
}

TEST(DeviceWatch, KeepsWhyTheDeviceWasLost) {
  DeviceWatch watch;
  watch.step(DeviceState::Absent, "not opened yet", seconds(1));
  watch.step(DeviceState::Ready, "", seconds(2));
  EXPECT_EQ(status_of(watch).last_loss.view(), "");
  watch.step(DeviceState::Absent, "hung up", seconds(3));
  watch.step(DeviceState::Starting, "is being started up", seconds(4));
  EXPECT_EQ(status_of(watch).last_loss.view(), "hung up");
  watch.step(DeviceState::Ready, "", seconds(5));
  EXPECT_EQ(status_of(watch).last_loss.view(), "hung up");
  watch.step(DeviceState::Starting, "no reply", seconds(6));
  EXPECT_EQ(status_of(watch).last_loss.view(), "no reply");
}

}  // namespace
}  // namespace slamsensor::firmware
