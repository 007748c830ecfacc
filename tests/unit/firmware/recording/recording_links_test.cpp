#include "firmware/recording/recording_links.hpp"

#include "firmware/recording/tape_writer.hpp"
#include "tests/support/no_alloc_scope.hpp"
#include "tests/support/scripted_can_link.hpp"
#include "tests/support/scripted_link.hpp"
#include "tests/unit/firmware/recording/kept_chunks.hpp"

#include <gtest/gtest.h>

#include <string>

namespace slamsensor::firmware {
namespace {

using tests::KeptChunks;

std::vector<std::uint8_t> ops_of(KeptChunks& kept, TapeWriter& tape) {
  EXPECT_TRUE(tape.finish());
  return kept.bytes(0);
}

TEST(RecordingByteLink, WithoutATapeItOnlyPassesOn) {
  tests::ScriptedLink line;
  line.set_up(true);
  line.deliver("hello", {}, 9600);
  line.set_now(std::chrono::seconds(1));
  RecordingByteLink link(line, HeadLink::PanTiltBytes);
  std::array<std::uint8_t, 16> bytes{};
  EXPECT_EQ(link.read(bytes).count, 5U);
  EXPECT_EQ(link.write(bytes), hal::LinkStatus::Ok);
  EXPECT_EQ(link.set_baud(19'200), hal::LinkStatus::Ok);
  EXPECT_EQ(link.baud(), 19'200U);
  EXPECT_TRUE(link.is_up());
  EXPECT_EQ(link.epoch(), 1U);
  EXPECT_EQ(line.take_writes().size(), 1U);
}

TEST(RecordingByteLink, WritesCallsResultsAndChangesOfState) {
  tests::ScriptedLink line;
  line.set_up(true);
  line.deliver("ab", {}, 9600);
  line.set_now(std::chrono::seconds(1));
  KeptChunks kept;
  TapeWriter tape(kept);
  RecordingByteLink link(line, HeadLink::RangefinderBytes);
  link.attach(&tape);
  tape.step(std::chrono::seconds(1));
  std::array<std::uint8_t, 16> bytes{};
  EXPECT_EQ(link.read(bytes).count, 2U);
  EXPECT_EQ(link.set_baud(300), hal::LinkStatus::Ok);
  line.set_up(false);
  link.service(std::chrono::seconds(1));
  EXPECT_EQ(link.read(bytes).status, hal::LinkStatus::Down);
  link.discard_input();
  const std::vector<std::uint8_t> expected = {
      0x02, 0x01, 0x01, 0x80, 0x4B,        // open: epoch 1, up, 9600
      0x10, 0x80, 0x94, 0xEB, 0xDC, 0x03,  // step
      0x62, 0x00, 0x02, 'a',  'b',         // read
      0x82, 0x00, 0xAC, 0x02,              // 300 baud
      0x32, 0x01, 0x01, 0xAC, 0x02,        // which the link now says
      0x22, 0x01, 0x00, 0xAC, 0x02,        // down, found by service()
      0x52,                                // a read that found it down
      0x92,                                // discard
      0xE0,
  };
  EXPECT_EQ(ops_of(kept, tape), expected);
}

TEST(RecordingByteLink, ReadsAtMostWhatATapeCarries) {
  tests::ScriptedLink line;
  line.set_up(true);
  line.deliver(std::string(20'000, 'x'), {}, 4'000'000);
  line.set_now(std::chrono::seconds(1));
  KeptChunks kept;
  TapeWriter tape(kept);
  RecordingByteLink link(line, HeadLink::RangefinderBytes);
  link.attach(&tape);
  std::vector<std::uint8_t> bytes(20'000);
  EXPECT_EQ(link.read(bytes).count, kTapeBytesMax);
  EXPECT_EQ(link.read(bytes).count, kTapeBytesMax);
  EXPECT_EQ(link.read(bytes).count, 20'000 - 2 * kTapeBytesMax);
  EXPECT_EQ(tape.lost(), 0U);
}

TEST(RecordingByteLink, AsksTheHeapForNothingWhileItRecords) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "the sanitizers' heap cannot be watched";
  }
  tests::ScriptedLink line;
  line.set_up(true);
  line.deliver(std::string(200'000, 'x'), {}, 4'000'000);
  line.set_now(std::chrono::seconds(10));
  TapeRing ring(4);
  TapeWriter tape(ring);
  RecordingByteLink link(line, HeadLink::RangefinderBytes);
  std::vector<std::uint8_t> bytes(4096);
  const tests::NoAllocScope scope;
  link.attach(&tape);
  for (int i = 0; i < 100; ++i) {  // six chunks and more: the ring overflows
    tape.step(std::chrono::seconds(10) + std::chrono::milliseconds(i));
    link.service(std::chrono::seconds(10));
    static_cast<void>(link.read(bytes));
    static_cast<void>(link.write(std::span(bytes).first(8)));
  }
  EXPECT_EQ(scope.heap_calls(), 0U);
  EXPECT_GT(tape.lost(), 0U);
}

TEST(RecordingHeadLinks, TapTheLinksThatAreThere) {
  tests::ScriptedLink line;
  tests::ScriptedCanLink bus;
  bus.set_up(true);
  bus.deliver({.id = 5, .size = 2, .data = {1, 2}});
  RecordingHeadLinks links({.pan_tilt_bytes = &line, .rangefinder_can = &bus});
  const HeadLinks taps = links.get();
  EXPECT_NE(taps.pan_tilt_bytes, nullptr);
  EXPECT_EQ(taps.pan_tilt_can, nullptr);
  EXPECT_EQ(taps.rangefinder_bytes, nullptr);
  ASSERT_NE(taps.rangefinder_can, nullptr);
  KeptChunks kept;
  TapeWriter tape(kept);
  links.attach(&tape);
  EXPECT_EQ(taps.rangefinder_can->receive().frame.id, 5U);
  EXPECT_EQ(taps.rangefinder_can->receive().status, hal::LinkStatus::Busy);
  links.attach(nullptr);
  EXPECT_EQ(taps.rangefinder_can->send({.id = 6}), hal::LinkStatus::Ok);
  const std::vector<std::uint8_t> expected = {
      0x00, 0x00, 0x00, 0x80, 0x4B, 0x03, 0x01, 0x01, 0x00,  // both are opened
      0xA3, 0x00, 0x05, 0x04, 0x01, 0x02,                    // the frame
      0x43,                                                  // and no other
      0xE0,
  };
  EXPECT_EQ(ops_of(kept, tape), expected);
}

}  // namespace
}  // namespace slamsensor::firmware
