#include "hal/transport/reopen.hpp"
#include "hal/transport/serial_port.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <string>

namespace slamsensor::hal {
namespace {

TEST(DeviceGroup, IsTheNameThatTheKernelLists) {
  EXPECT_EQ(device_group("/dev/null").view(), "mem");
  EXPECT_EQ(device_group("/dev/tty").view(), "/dev/tty");
  EXPECT_EQ(device_group("/proc/devices").view(), "") << "no device";
  EXPECT_EQ(device_group("/dev/no-such-device").view(), "");
}

TEST(DeviceGroup, GivesTheLineThatLetsTheServiceIn) {
  const DeniedAdvice advice("ttyXYZ");
  EXPECT_EQ(
      describe("serial port", "/dev/ttyXYZ0", {"open", EPERM, advice.view()}).view(),
      "serial port /dev/ttyXYZ0: open: Operation not permitted; the unit keeps it from the service: add the "
      "line DeviceAllow=char-ttyXYZ rw (systemctl edit slamsensor), and restart");
  const std::string longest(32, 'x');
  EXPECT_TRUE(DeniedAdvice(longest).view().ends_with("and restart"));
}

}  // namespace
}  // namespace slamsensor::hal
