#include "tools/emulator/emulated_port.hpp"

#include "tests/unit/tools/emulator/small_devices.hpp"

#include <gtest/gtest.h>

#include <string>

namespace slamsensor::tools {
namespace {

std::string taken(EmulatedPort& port, Stamp now) {
  port.advance(now);
  std::array<WireByte, 512> bytes;
  const std::size_t count = port.host_take(bytes, now);
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text.push_back(static_cast<char>(bytes[i].value));
  }
  return text;
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

struct Rig {
  EmulatedPort port{1};
  EchoDevice device{port, 9600, 3ms};

  Rig() { port.attach(device); }
  void say(const std::string& text, Stamp now) {
    port.advance(now);
    port.host_write(bytes_of(text), now);
  }
};

TEST(EmulatedPort, BytesTakeTheirTimeBothWays) {
  Rig rig;
  rig.say("pp ", 10ms);
  EXPECT_EQ(rig.port.next_event(), 10ms + hal::line_time(1, 9600));
  const Stamp back = 10ms + hal::line_time(1, 9600) + 3ms + hal::line_time(1, 9600);
  EXPECT_EQ(taken(rig.port, back - 1ns), "");
  EXPECT_EQ(rig.port.next_delivery(), back);
  EXPECT_EQ(taken(rig.port, back), "p");
  EXPECT_EQ(taken(rig.port, 1s), "p ");
  ASSERT_EQ(rig.device.heard.size(), 3U);
  EXPECT_EQ(rig.device.heard[2].at, 10ms + hal::line_time(3, 9600));
}

TEST(EmulatedPort, StepsOfAnySizeGiveTheSameBytes) {
  const auto run = [](Stamp step) {
    Rig rig;
    rig.say("the same", 0ns);
    std::string all;
    for (Stamp now{}; now <= 100ms; now += step) {
      all += taken(rig.port, now);
    }
    return all;
  };
  EXPECT_EQ(run(100us), "the same");
  EXPECT_EQ(run(7ms), run(100us));
}

TEST(EmulatedPort, AHostAtTheWrongRateIsNotUnderstood) {
  Rig rig;
  rig.port.set_host_baud(38400);
  rig.say("V V V V ", 0ns);
  rig.port.advance(1s);
  std::string heard;
  for (const auto& byte : rig.device.heard) {
    heard.push_back(static_cast<char>(byte.byte));
  }
  EXPECT_EQ(heard.find('V'), std::string::npos);
  EXPECT_LT(heard.size(), 5U);
  taken(rig.port, 2s);
  rig.port.set_host_baud(9600);
  rig.device.heard.clear();
  rig.say("V", 2s);
  EXPECT_EQ(taken(rig.port, 3s), "V");
}

TEST(EmulatedPort, ADeviceThatChangesItsRateMidwayHearsTheRestAtTheNewOne) {
  Rig rig;
  rig.say("ab", 0ns);
  rig.port.advance(hal::line_time(1, 9600));
  rig.device.set_baud(115200);
  rig.port.advance(1s);
  EXPECT_EQ(rig.device.heard.at(0).byte, 'a');
  EXPECT_NE(rig.device.heard.at(1).byte, 'b');
}

TEST(EmulatedPort, CableOutLosesWhatIsOnTheLineAndComesBack) {
  Rig rig;
  rig.say("hello", 0ns);
  rig.port.advance(2ms);
  ASSERT_TRUE(rig.port.inject({FaultKind::CableOut, 2ms, 500ms}));
  EXPECT_FALSE(rig.port.is_plugged());
  rig.say("lost", 100ms);
  EXPECT_EQ(taken(rig.port, 501ms), "");
  EXPECT_FALSE(rig.port.is_plugged());
  EXPECT_EQ(rig.port.next_event(), 502ms);
  EXPECT_EQ(taken(rig.port, 502ms), "");
  EXPECT_TRUE(rig.port.is_plugged());
  EXPECT_EQ(rig.port.plug_count(), 2U);
  rig.say("x", 600ms);
  EXPECT_EQ(taken(rig.port, 1s), "x");
}

TEST(EmulatedPort, FaultsGoToTheLineOrToTheDeviceOrNowhere) {
  Rig rig;
  EXPECT_TRUE(rig.port.inject({FaultKind::DropByte, 0ns, 0ns}));
  EXPECT_TRUE(rig.port.inject({FaultKind::PowerCycle, 0ns, 0ns}));
  EXPECT_FALSE(rig.port.inject({FaultKind::BusOff, 0ns, 0ns}));
  rig.say("ab", 0ns);
  EXPECT_EQ(taken(rig.port, 1s), "b");
}

TEST(EmulatedPort, WhatNobodyTakesIsBoundedAndCounted) {
  Rig rig;
  const std::vector<std::uint8_t> block(10'000, 'x');
  for (int i = 0; i < 10; ++i) {
    rig.port.advance(i * 20s);
    rig.port.send(block, i * 20s);
  }
  rig.port.advance(300s);
  EXPECT_EQ(rig.port.overruns(), 100'000U - 65'536U);
}

/// Asks for the same moment for ever.
class StuckDevice final : public EmulatedSerialDevice {
 public:
  void advance(Stamp) override {}
  [[nodiscard]] Stamp next_event() const override { return 1ms; }
  bool inject(const Fault&) override { return false; }
  void receive(std::uint8_t, Stamp) override {}
  [[nodiscard]] std::uint32_t baud() const override { return 9600; }
};

TEST(EmulatedPort, ADeviceThatDoesNotGetOnEndsInAnErrorNotInALoop) {
  EmulatedPort port(1);
  StuckDevice device;
  port.attach(device);
  EXPECT_THROW(port.advance(1s), std::logic_error);
}

}  // namespace
}  // namespace slamsensor::tools
