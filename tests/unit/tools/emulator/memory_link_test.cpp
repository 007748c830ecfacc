#include "tests/unit/tools/emulator/small_devices.hpp"
#include "tools/emulator/emulated_port.hpp"

#include <gtest/gtest.h>

#include <string>

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

TEST(MemoryLink, IsDownUntilServiced) {
  Rig rig;
  EXPECT_EQ(rig.link.epoch(), 0U);
  EXPECT_EQ(rig.write("a"), LinkStatus::Down);
  rig.read();
  EXPECT_EQ(rig.last.status, LinkStatus::Down);
  rig.go(0ns);
  EXPECT_TRUE(rig.link.is_up());
  EXPECT_EQ(rig.link.epoch(), 1U);
}

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

TEST(MemoryLink, WritesAllOrNothing) {
  MemoryLinkConfig config;
  config.write_queue = 10;
  Rig rig(config);
  rig.go(0ns);
  EXPECT_EQ(rig.write("12345678"), LinkStatus::Ok);
  EXPECT_EQ(rig.write("123"), LinkStatus::Busy);
  EXPECT_EQ(rig.write("12"), LinkStatus::Ok);
  EXPECT_EQ(rig.write(std::string(11, 'x')), LinkStatus::Busy);
  rig.go(2ms);
  EXPECT_EQ(rig.write("9"), LinkStatus::Ok);
  rig.go(1s);
  EXPECT_EQ(rig.read(), "12345678129");
}

TEST(MemoryLink, ComesBackAfterTheCableWithBackOffAndANewEpoch) {
  Rig rig;
  rig.go(0ns);
  rig.go(5s);
  ASSERT_TRUE(rig.port.inject({FaultKind::CableOut, 5s, 1s}));
  rig.read();
  EXPECT_EQ(rig.last.status, LinkStatus::Down);
  EXPECT_EQ(rig.write("x"), LinkStatus::Down);
  Stamp back{};
  for (Stamp now = 5s; now < 10s && back == Stamp{}; now += 10ms) {
    rig.go(now);
    back = rig.link.is_up() ? now : Stamp{};
  }
  EXPECT_GE(back, 6s);
  EXPECT_LE(back, 6s + 1s);
  EXPECT_EQ(rig.link.epoch(), 2U);
  ASSERT_EQ(rig.write("y"), LinkStatus::Ok);
  rig.go(10s);
  EXPECT_EQ(rig.read(), "y");
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

TEST(MemoryLink, KeepsItsRateOverALossAndRefusesNonsense) {
  Rig rig;
  EXPECT_EQ(rig.link.set_baud(38400), LinkStatus::Down);
  rig.go(0ns);
  EXPECT_EQ(rig.link.baud(), 38400U);
  EXPECT_EQ(rig.port.host_baud(), 38400U);
  EXPECT_EQ(rig.link.set_baud(0), LinkStatus::Down);
  EXPECT_EQ(rig.link.baud(), 38400U);
  EXPECT_EQ(rig.link.set_baud(9600), LinkStatus::Ok);
  ASSERT_EQ(rig.write("q"), LinkStatus::Ok);
  rig.go(1s);
  EXPECT_EQ(rig.read(), "q");
}

TEST(MemoryLink, DiscardsWhatHasArrived) {
  Rig rig;
  rig.go(0ns);
  ASSERT_EQ(rig.write("old"), LinkStatus::Ok);
  rig.go(1s);
  rig.link.discard_input();
  EXPECT_EQ(rig.read(), "");
  ASSERT_EQ(rig.write("new"), LinkStatus::Ok);
  rig.go(2s);
  EXPECT_EQ(rig.read(), "new");
}

TEST(MemoryLink, ReadsMoreThanItMovesAtATime) {
  Rig rig;
  rig.go(0ns);
  ASSERT_EQ(rig.write(std::string(290, 'z')), LinkStatus::Ok);
  rig.go(1s);
  EXPECT_EQ(rig.read(), std::string(290, 'z'));
}

}  // namespace
}  // namespace slamsensor::tools
