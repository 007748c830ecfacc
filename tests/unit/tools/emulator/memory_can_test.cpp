#include "tests/unit/tools/emulator/small_devices.hpp"
#include "tools/emulator/memory_can_bus.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::tools {
namespace {

using hal::CanFrame;
using hal::LinkStatus;

CanFrame frame_of(std::uint32_t id, std::uint8_t size = 8) {
  CanFrame frame;
  frame.id = id;
  frame.size = size;
  frame.data = {0x55, 0x33, 0x55, 0x33, 0x55, 0x33, 0x55, 0x33};
  return frame;
}

/// Keeps what it hears and sends `id` + 1 back for every `id` it is told to answer.
class ListeningNode final : public EmulatedCanDevice {
 public:
  ListeningNode(FrameSink& sink, std::uint32_t answers) : sink_(sink), answers_(answers) {}

  void advance(Stamp) override {}
  [[nodiscard]] Stamp next_event() const override { return hal::kNever; }
  bool inject(const Fault&) override { return false; }
  void receive(const CanFrame& frame, Stamp at) override {
    heard.push_back({frame, at});
    if (frame.id == answers_) {
      sink_.send(frame_of(frame.id + 1), at + 1ms);
    }
  }

  std::vector<MemoryCanBus::Arrival> heard;

 private:
  FrameSink& sink_;
  std::uint32_t answers_;
};

struct Rig {
  MemoryCanBus bus;
  SimClock clock;
  FrameSink& sink_a = bus.add_device_node();
  FrameSink& sink_b = bus.add_device_node();
  ListeningNode a{sink_a, 0x100};
  ListeningNode b{sink_b, 0x200};
  MemoryCanLink link{bus, clock};

  Rig() {
    bus.attach(sink_a, a);
    bus.attach(sink_b, b);
  }
  void go(Stamp now) {
    bus.advance(now);
    clock.now = now;
    link.service(now);
  }
};

TEST(CanFrameTime, CountsEveryBitOnTheBus) {
  // 0x555 without data: 0 10101010101 000 0000 and a checksum; stuff bits follow five equal ones.
  CanFrame empty;
  empty.id = 0x555;
  EXPECT_GE(can_frame_bits(empty), 47U + 1U);
  EXPECT_LE(can_frame_bits(empty), 47U + 8U);
  // No frame is shorter than 44 + 8n + 3 bits nor longer than with a stuff bit after every fourth.
  for (std::uint8_t size = 0; size <= 8; ++size) {
    const std::size_t plain = 47U + 8U * size;
    EXPECT_GE(can_frame_bits(frame_of(0x2AA, size)), plain);
    EXPECT_LE(can_frame_bits(frame_of(0x2AA, size)), plain + (33U + 8U * size) / 4U);
  }
  CanFrame extended = frame_of(0x15555555);
  extended.extended = true;
  EXPECT_GE(can_frame_bits(extended), 131U);
  EXPECT_LE(can_frame_bits(extended), 131U + 29U);
  CanFrame zeros;
  zeros.size = 8;
  // 82 zero bits and one after "1000": a stuff bit after each five, then four between; checksum included.
  EXPECT_GT(can_frame_bits(zeros), 111U + 15U);
}

TEST(CanFrameTime, ArbitrationFollowsTheIdentifier) {
  CanFrame extended = frame_of(0x100U << 18U);
  extended.extended = true;
  EXPECT_LT(arbitration_key(frame_of(0x0FF)), arbitration_key(frame_of(0x100)));
  EXPECT_LT(arbitration_key(frame_of(0x100)), arbitration_key(extended));
  EXPECT_LT(arbitration_key(extended), arbitration_key(frame_of(0x101)));
}

TEST(MemoryCan, FramesTakeTheirTimeAndReachEveryOtherNode) {
  Rig rig;
  rig.go(0ns);
  ASSERT_EQ(rig.link.send(frame_of(0x100)), LinkStatus::Ok);
  const Stamp length = can_frame_time(frame_of(0x100), 1'000'000);
  EXPECT_GT(length, 110us);
  EXPECT_LT(length, 136us);
  rig.go(length - 1ns);
  EXPECT_TRUE(rig.a.heard.empty());
  rig.go(length);
  ASSERT_EQ(rig.a.heard.size(), 1U);
  EXPECT_EQ(rig.a.heard[0].at, length);
  EXPECT_EQ(rig.b.heard.size(), 1U);
  EXPECT_EQ(rig.link.receive().status, LinkStatus::Busy);  // not its own
  rig.go(1s);
  const hal::CanRead answer = rig.link.receive();
  ASSERT_EQ(answer.status, LinkStatus::Ok);
  EXPECT_EQ(answer.frame.id, 0x101U);
  EXPECT_EQ(answer.stamp, length + 1ms + can_frame_time(frame_of(0x101), 1'000'000));
  EXPECT_EQ(rig.b.heard.size(), 2U);
  EXPECT_EQ(rig.a.heard.size(), 1U);
}

TEST(MemoryCan, TheLowestIdentifierGoesFirst) {
  Rig rig;
  rig.go(0ns);
  rig.sink_a.send(frame_of(0x300), 0ns);
  rig.sink_a.send(frame_of(0x001), 0ns);  // behind it in the same queue
  rig.sink_b.send(frame_of(0x200), 0ns);
  rig.sink_b.send(frame_of(0x400), 0ns);
  rig.go(1s);
  std::vector<std::uint32_t> order;
  for (hal::CanRead read = rig.link.receive(); read.status == LinkStatus::Ok; read = rig.link.receive()) {
    order.push_back(read.frame.id);
  }
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x200, 0x300, 0x001, 0x400}));
}

TEST(MemoryCan, AFullQueueIsBusy) {
  Rig rig;
  rig.go(0ns);
  std::size_t sent = 0;
  while (rig.link.send(frame_of(0x500)) == LinkStatus::Ok) {
    ++sent;
  }
  EXPECT_EQ(sent, MemoryCanBus::kHostQueue);
  rig.go(1ms);
  EXPECT_EQ(rig.link.send(frame_of(0x500)), LinkStatus::Ok);
}

TEST(MemoryCan, DownAndBusOffLoseFramesAndComeBackWithANewEpoch) {
  for (const FaultKind kind : {FaultKind::InterfaceDown, FaultKind::BusOff}) {
    Rig rig;
    rig.go(0ns);
    EXPECT_EQ(rig.link.epoch(), 1U);
    rig.go(5s);
    ASSERT_TRUE(rig.bus.inject({kind, 5s, 300ms}));
    EXPECT_EQ(rig.link.receive().status, LinkStatus::Down);
    EXPECT_EQ(rig.link.send(frame_of(1)), LinkStatus::Down);
    rig.sink_a.send(frame_of(0x77), 5s + 1ms);
    for (Stamp now = 5s; now < 7s; now += 5ms) {
      rig.go(now);
    }
    EXPECT_EQ(rig.link.epoch(), 2U);
    EXPECT_EQ(rig.link.receive().status, LinkStatus::Busy);
    EXPECT_EQ(rig.b.heard.size(), 1U);  // the devices' own bus was not down
  }
}

TEST(MemoryCan, ALostFrameIsLostForTheHostAlone) {
  Rig rig;
  rig.go(0ns);
  ASSERT_TRUE(rig.bus.inject({FaultKind::LostFrame, 0ns, 0ns}));
  rig.sink_a.send(frame_of(0x10), 0ns);
  rig.sink_a.send(frame_of(0x11), 0ns);
  rig.go(1s);
  EXPECT_EQ(rig.link.receive().frame.id, 0x11U);
  EXPECT_EQ(rig.b.heard.size(), 2U);
  EXPECT_FALSE(rig.bus.inject({FaultKind::DropByte, 1s, 0ns}));
}

}  // namespace
}  // namespace slamsensor::tools
