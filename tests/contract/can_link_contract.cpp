#include "tests/contract/can_link_contract.hpp"

#include "tests/contract/can_frames.hpp"
#include "tests/support/no_alloc_scope.hpp"

#include <gmock/gmock.h>

namespace slamsensor::tests {
namespace {

using hal::CanFrame;
using hal::CanRead;
using hal::LinkStatus;
using testing::ElementsAre;

/// Both kinds of identifier at both ends of their range, and every length.
std::vector<CanFrame> all_kinds() {
  std::vector<CanFrame> frames = {make_frame(0, {}), make_frame(0x7FF, {1}), make_extended(0, {2}),
                                  make_extended(0x7FF, {3}), make_extended(0x1FFF'FFFF, {4})};
  for (std::uint8_t size = 0; size <= 8; ++size) {
    CanFrame frame = make_frame(0x580U + size, {});
    frame.size = size;
    for (std::uint8_t i = 0; i < size; ++i) {
      frame.data.at(i) = static_cast<std::uint8_t>(0xF0U + i);
    }
    frames.push_back(frame);
  }
  return frames;
}

TEST_P(CanLinkContract, IsDownUntilItIsServiced) {
  EXPECT_FALSE(link().is_up());
  EXPECT_EQ(link().epoch(), 0U);
  EXPECT_EQ(link().receive().status, LinkStatus::Down);
  EXPECT_EQ(link().send(make_frame(1, {})), LinkStatus::Down);
  come_up();
  EXPECT_EQ(link().epoch(), 1U);
  EXPECT_EQ(link().receive().status, LinkStatus::Busy);
}

TEST_P(CanLinkContract, ReceivesEveryKindOfDataFrameInOrder) {
  come_up();
  const std::vector<CanFrame> sent = all_kinds();
  std::vector<CanFrame> got;
  for (const CanFrame& frame : sent) {  // one at a time: on a bus the lowest identifier would go first
    rig_->peer_send(frame);
    for (const CanFrame& received : receive(1)) {
      got.push_back(received);
    }
  }
  EXPECT_EQ(got, sent);
}

TEST_P(CanLinkContract, SendsEveryKindOfDataFrameInOrder) {
  come_up();
  const std::vector<CanFrame> sent = all_kinds();
  for (const CanFrame& frame : sent) {
    send(frame);
  }
  EXPECT_EQ(peer_receive(sent.size()), sent);
}

TEST_P(CanLinkContract, DoesNotHearItself) {
  come_up();
  send(make_frame(0x123, {1, 2, 3}));
  EXPECT_THAT(peer_receive(1), ElementsAre(make_frame(0x123, {1, 2, 3})));
  rig_->peer_send(make_frame(0x321, {4}));
  EXPECT_THAT(receive(1), ElementsAre(make_frame(0x321, {4})));
}

TEST_P(CanLinkContract, SendsNoImpossibleFrame) {
  come_up();
  CanFrame too_long = make_frame(1, {1});
  too_long.size = 9;
  for (const CanFrame& frame : {too_long, make_frame(0x800, {}), make_extended(0x2000'0000, {})}) {
    EXPECT_NE(link().send(frame), LinkStatus::Ok);
  }
  EXPECT_TRUE(link().is_up());
  send(make_frame(7, {7}));
  EXPECT_THAT(peer_receive(1), ElementsAre(make_frame(7, {7})));
}

TEST_P(CanLinkContract, LosesNothingThatItTook) {
  come_up();
  std::vector<CanFrame> sent;
  for (std::uint8_t i = 0; i < 150; ++i) {
    const CanFrame frame = make_frame(0x200, {i, 0x5A});
    if (link().send(frame) == LinkStatus::Ok) {  // else the queue is full, which it may be
      sent.push_back(frame);
    }
  }
  EXPECT_TRUE(link().is_up());
  EXPECT_EQ(peer_receive(sent.size()), sent);
}

TEST_P(CanLinkContract, StampsLieBetweenSendingAndReceiving) {
  come_up();
  hal::Stamp last{};
  for (std::uint8_t i = 0; i < 20; ++i) {
    const hal::Stamp before = rig_->stamping_clock();
    rig_->peer_send(make_frame(0x100, {i}));
    CanRead read;
    ASSERT_TRUE(step_until([&] {
      read = link().receive();
      return read.status == LinkStatus::Ok;
    }));
    EXPECT_GE(read.stamp, before - std::chrono::microseconds(50));  // two clocks are compared by the kernel's
    EXPECT_LE(read.stamp, rig_->stamping_clock());
    EXPECT_GE(read.stamp, last);
    last = read.stamp;
  }
}

TEST_P(CanLinkContract, ComesBackAfterALoss) {
  come_up();
  for (std::uint32_t i = 1; i <= 3; ++i) {
    cut_and_notice();
    EXPECT_EQ(link().receive().status, LinkStatus::Down);
    EXPECT_EQ(link().send(make_frame(1, {})), LinkStatus::Down);
    EXPECT_EQ(link().epoch(), i);
    rig_->restore();
    come_up();
    EXPECT_EQ(link().epoch(), i + 1);
    rig_->peer_send(make_frame(0x10, {1}));
    EXPECT_THAT(receive(1), ElementsAre(make_frame(0x10, {1})));
    send(make_frame(0x11, {2}));
    EXPECT_THAT(peer_receive(1), ElementsAre(make_frame(0x11, {2})));
  }
}

TEST_P(CanLinkContract, StaysDownWithTheInterfaceAndIsBackWithinTheLongestWait) {
  come_up();
  cut_and_notice();
  for (int i = 0; i < 1000; ++i) {
    step(std::chrono::milliseconds(10));
    ASSERT_FALSE(link().is_up());
  }
  rig_->restore();
  const hal::Stamp restored = rig_->now();
  come_up();
  EXPECT_LE(rig_->now() - restored, std::chrono::milliseconds(2001));
  EXPECT_EQ(link().epoch(), 2U);
}

TEST_P(CanLinkContract, NeverAsksTheHeap) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizer's heap cannot be watched";
  }
  come_up();
  std::uint64_t calls = 0;
  const auto work = [&] {
    rig_->pass(std::chrono::milliseconds(10));
    const NoAllocScope scope;
    link().service(rig_->now());
    static_cast<void>(link().receive());
    static_cast<void>(link().send(make_frame(3, {3})));
    calls += scope.heap_calls();
  };
  for (int i = 0; i < 50; ++i) {
    rig_->peer_send(make_frame(0x10, {1}));
    work();
  }
  rig_->cut();
  for (int i = 0; i < 300; ++i) {
    work();
  }
  EXPECT_FALSE(link().is_up());
  rig_->restore();
  for (int i = 0; i < 300; ++i) {
    work();
  }
  EXPECT_TRUE(link().is_up());
  if (rig_->promises_no_heap()) {
    EXPECT_EQ(calls, 0U);
  }
}

}  // namespace
}  // namespace slamsensor::tests
