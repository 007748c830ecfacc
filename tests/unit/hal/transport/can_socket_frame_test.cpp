#include "hal/transport/can_socket.hpp"

#include <gtest/gtest.h>

#include <linux/can/error.h>

namespace slamsensor::hal {
namespace {

canfd_frame raw(canid_t id, std::uint8_t length, std::uint8_t second = 0) {
  canfd_frame frame{};
  frame.can_id = id;
  frame.len = length;
  for (std::size_t i = 0; i < 8; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(i + 1);
  }
  frame.data[1] = second;
  return frame;
}

TEST(CanSocketFrame, DataFramesAreDecoded) {
  CanCounters counters(can_event_names());
  const auto standard = to_data_frame(raw(0x181, 3, 9), CAN_MTU, counters);
  ASSERT_TRUE(standard);
  EXPECT_EQ(*standard, (CanFrame{0x181, false, 3, {1, 9, 3}}));
  const auto extended = to_data_frame(raw(0x1FFF'FFFFU | CAN_EFF_FLAG, 0), CAN_MTU, counters);
  ASSERT_TRUE(extended);
  EXPECT_EQ(*extended, (CanFrame{0x1FFF'FFFF, true, 0, {}}));
}

TEST(CanSocketFrame, WhatIsNoDataFrameIsCounted) {
  CanCounters counters(can_event_names());
  EXPECT_FALSE(to_data_frame(raw(0x181 | CAN_RTR_FLAG, 8), CAN_MTU, counters));
  EXPECT_FALSE(to_data_frame(raw(0x181, 64), CANFD_MTU, counters));
  EXPECT_EQ(counters[CanEvent::RemoteIgnored], 1U);
  EXPECT_EQ(counters[CanEvent::FdIgnored], 1U);
}

TEST(CanSocketFrame, ALengthBeyondTheDataIsRefused) {
  CanCounters counters(can_event_names());
  EXPECT_FALSE(to_data_frame(raw(0x181, 9), CAN_MTU, counters));
  EXPECT_FALSE(to_data_frame(raw(0x181, 255), CAN_MTU, counters));
  for (const std::size_t bytes : {std::size_t{0}, CAN_MTU - 1, CAN_MTU + 1, CANFD_MTU - 1}) {
    EXPECT_FALSE(to_data_frame(raw(0x181, 8), bytes, counters)) << bytes;
  }
  EXPECT_EQ(counters[CanEvent::BadFrame], 6U);
}

TEST(CanSocketFrame, FramesToSendAreBounded) {
  EXPECT_FALSE(to_raw({0x800, false, 0, {}}));
  EXPECT_FALSE(to_raw({0x2000'0000, true, 0, {}}));
  EXPECT_FALSE(to_raw({0x1, false, 9, {}}));
  const auto extended = to_raw({0x7, true, 2, {5, 6, 7}});
  ASSERT_TRUE(extended);
  EXPECT_EQ(extended->can_id, 0x7U | CAN_EFF_FLAG);
  EXPECT_EQ(extended->len, 2);
  EXPECT_EQ(extended->data[1], 6);
}

TEST(CanSocketFrame, ErrorFramesAreKnownByTheirFlag) {
  EXPECT_TRUE(is_error_frame(raw(CAN_ERR_FLAG | CAN_ERR_ACK, 8), CAN_MTU));
  EXPECT_FALSE(is_error_frame(raw(0x20, 8), CAN_MTU));
  EXPECT_FALSE(is_error_frame(raw(CAN_ERR_FLAG | CAN_ERR_ACK, 8), CANFD_MTU));
}

TEST(CanSocketFrame, ErrorFramesAreCountedByKind) {
  CanCounters counters(can_event_names());
  EXPECT_EQ(take_error_frame(raw(CAN_ERR_FLAG | CAN_ERR_ACK | CAN_ERR_TX_TIMEOUT, 8), counters),
            BusState::On);
  EXPECT_EQ(take_error_frame(raw(CAN_ERR_FLAG | CAN_ERR_CRTL, 8, CAN_ERR_CRTL_RX_PASSIVE), counters),
            BusState::On);
  EXPECT_EQ(take_error_frame(raw(CAN_ERR_FLAG | CAN_ERR_CRTL, 8, CAN_ERR_CRTL_RX_OVERFLOW), counters),
            BusState::On);
  EXPECT_EQ(take_error_frame(raw(CAN_ERR_FLAG | CAN_ERR_BUSOFF, 8, 0xFF), counters), BusState::Off);
  EXPECT_EQ(take_error_frame(raw(CAN_ERR_FLAG | CAN_ERR_RESTARTED, 8), counters), BusState::Off);
  EXPECT_EQ(counters[CanEvent::NoAck], 1U);
  EXPECT_EQ(counters[CanEvent::TxTimeout], 1U);
  EXPECT_EQ(counters[CanEvent::ErrorPassive], 1U);
  EXPECT_EQ(counters[CanEvent::RxOverflow], 1U);
  EXPECT_EQ(counters[CanEvent::BusOff], 1U);
  EXPECT_EQ(counters[CanEvent::Restarted], 1U);
  EXPECT_EQ(counters[CanEvent::ErrorWarning], 0U);
}

TEST(CanSocketFrame, ArrivalIsMovedToTheMonotonicClock) {
  using std::chrono::seconds;
  const Stamp ahead = seconds(1'700'000'000);
  const Stamp now = seconds(100);
  EXPECT_EQ(monotonic_stamp(ahead + seconds(99), ahead, now), seconds(99));
  EXPECT_EQ(monotonic_stamp(ahead + now, ahead, now), now);
  EXPECT_EQ(monotonic_stamp(ahead + now + Stamp(1), ahead, now), std::nullopt);
  EXPECT_EQ(monotonic_stamp(ahead + seconds(98), ahead, now), seconds(98));
  EXPECT_EQ(monotonic_stamp(ahead + seconds(98) - Stamp(1), ahead, now), std::nullopt);
  // The wall clock was set a day back or forth between arrival and reading.
  EXPECT_EQ(monotonic_stamp(ahead + now, ahead - seconds(86'400), now), std::nullopt);
  EXPECT_EQ(monotonic_stamp(ahead + now, ahead + seconds(86'400), now), std::nullopt);
}

}  // namespace
}  // namespace slamsensor::hal
