#include "tests/unit/tools/emulator/rangefinder/bench.hpp"
#include "tools/emulator/rangefinder/emulated_tf03.hpp"

#include <utility>

namespace slamsensor::tools {
namespace {

class FrameBench : public FrameSink {
 public:
  explicit FrameBench(const Tf03Settings& settings) : device(settings, *this, scene) {}

  void send(const hal::CanFrame& frame, Stamp at) override { sent.push_back({frame, at}); }

  struct Sent {
    hal::CanFrame frame;
    Stamp at;
  };

  std::vector<Sent> run(Stamp length) {
    now += length;
    device.advance(now);
    return std::exchange(sent, {});
  }

  std::vector<Sent> say(const std::string& command, Stamp wait = 1ms) {
    const Bytes bytes = from_hex(command);
    hal::CanFrame frame{.id = 0x3003, .extended = true, .size = static_cast<std::uint8_t>(bytes.size())};
    std::ranges::copy(bytes, frame.data.begin());
    device.receive(frame, now);
    return run(wait);
  }

  BenchScene scene;
  EmulatedTf03Can device;
  std::vector<Sent> sent;
  Stamp now{};
};

Tf03Settings on_can() {
  Tf03Settings settings;
  settings.begin = DeviceBegin::Ready;
  settings.saved.wire = Tf03Wire::Can;
  return settings;
}

TEST(Tf03Can, FrameIsThatOfTheManual) {
  FrameBench bench(on_can());
  bench.scene.target.reflectance = 1200.3 * 12.34 * 12.34 / 1.44e6;
  const auto frames = bench.run(10ms);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].frame.id, 0x003U);
  EXPECT_FALSE(frames[0].frame.extended);
  EXPECT_EQ(hex(frames[0].frame.bytes()), "D2 04 B0 04 00 00 00 00");
  EXPECT_EQ(frames[0].at, 10ms);
  ASSERT_EQ(bench.scene.reports.size(), 1U);
  EXPECT_EQ(bench.scene.reports[0].on_wire, 10ms);
}

TEST(Tf03Can, CommandsComeOverTheBus) {
  FrameBench bench(on_can());
  EXPECT_EQ(hex(bench.say("5A 04 01 5F").at(0).frame.bytes()), "5A 07 01 02 02 01 67");
  EXPECT_EQ(hex(bench.say("5A 06 03 E8 03 4E", 0ms).at(0).frame.bytes()), "5A 06 03 E8 03 4E");
  const auto frames = bench.run(1s);
  EXPECT_EQ(frames.size(), 1000U);
  EXPECT_EQ(frames[1].at - frames[0].at, 1ms);
}

TEST(Tf03Can, OtherIdentifiersAreNotForIt) {
  FrameBench bench(on_can());
  hal::CanFrame frame{.id = 0x3004, .extended = true, .size = 4, .data = {0x5A, 4, 1, 0x5F}};
  bench.device.receive(frame, bench.now);
  EXPECT_TRUE(bench.run(1ms).empty());
}

TEST(Tf03Can, IsMuteOnUartAndAtAnotherBitRate) {
  Tf03Settings settings = on_can();
  settings.saved.wire = Tf03Wire::Uart;
  FrameBench uart(settings);
  EXPECT_TRUE(uart.run(1s).empty());
  settings = on_can();
  settings.saved.can_baud = 500'000;
  FrameBench slow(settings);
  EXPECT_TRUE(slow.run(1s).empty());
  EXPECT_TRUE(slow.say("5A 04 01 5F").empty());
}

TEST(Tf03Can, KnowsTheFaultsOfABus) {
  FrameBench bench(on_can());
  EXPECT_TRUE(bench.device.inject({FaultKind::PowerCycle, bench.now, 100ms}));
  EXPECT_EQ(bench.device.next_event(), 400ms);
  EXPECT_TRUE(bench.run(400ms).empty());
  EXPECT_FALSE(bench.run(10ms).empty());
  EXPECT_TRUE(bench.device.inject({FaultKind::Silence, bench.now, 50ms}));
  EXPECT_TRUE(bench.run(49ms).empty());
  for (const FaultKind kind : {FaultKind::BaudReset, FaultKind::BadChecksum, FaultKind::TextMessage,
                               FaultKind::LostFrame, FaultKind::DeviceError}) {
    EXPECT_FALSE(bench.device.inject({kind, bench.now, 1s}));
  }
}

}  // namespace
}  // namespace slamsensor::tools
