#include "tests/unit/tools/emulator/small_devices.hpp"
#include "tools/emulator/emulated_port.hpp"

#include <gtest/gtest.h>

#include <string>

// What tests/contract does not ask of this link: the line's time, the adapter's, a short loss.
namespace slamsensor::tools {
namespace {

using hal::LinkStatus;

struct Rig {
  explicit Rig(const MemoryLinkConfig& config = {}) : link(port, clock, config) { port.attach(device); }

  void go(Stamp now) {
    port.advance(now);
    clock.now = now;
    link.service(now);
  }
  LinkStatus write(const std::string& text) {
    return link.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  std::string read() {
    std::array<std::uint8_t, 300> bytes;
    const hal::ByteRead got = link.read(bytes);
    last = got;
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(got.count)};
  }

  EmulatedPort port{1};
  SimClock clock;
  EchoDevice device{port, 9600};
  MemoryLink link;
  hal::ByteRead last;
};

TEST(MemoryLink, CarriesBytesAtTheLineRate) {
  Rig rig;
  rig.go(0ns);
  ASSERT_EQ(rig.write("V "), LinkStatus::Ok);
  rig.go(2ms);
  EXPECT_EQ(rig.read(), "");
  EXPECT_EQ(rig.last.status, LinkStatus::Busy);
  rig.go(3ms);
  EXPECT_EQ(rig.read(), "V");
  EXPECT_EQ(rig.last.status, LinkStatus::Ok);
  EXPECT_EQ(rig.last.stamp, 3ms);
  rig.go(4ms);
  EXPECT_EQ(rig.read(), " ");
}

TEST(MemoryLink, AUsbAdapterHandsOverInBatches) {
  MemoryLinkConfig config;
  config.batch = 16ms;
  Rig rig(config);
  rig.go(0ns);
  ASSERT_EQ(rig.write("abc"), LinkStatus::Ok);
  rig.go(15ms);
  EXPECT_EQ(rig.read(), "");
  rig.go(17ms);
  EXPECT_EQ(rig.read(), "abc");
}

TEST(MemoryLink, ACableOutBetweenTwoCallsIsStillALoss) {
  Rig rig;
  rig.go(0ns);
  ASSERT_TRUE(rig.port.inject({FaultKind::CableOut, 0ns, 1ms}));
  rig.port.advance(5ms);
  rig.clock.now = 5ms;
  rig.read();
  EXPECT_EQ(rig.last.status, LinkStatus::Down);
  rig.go(5s);
  EXPECT_EQ(rig.link.epoch(), 2U);
}

}  // namespace
}  // namespace slamsensor::tools
