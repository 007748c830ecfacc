#include "firmware/recording/tape_writer.hpp"

#include "tests/unit/firmware/recording/kept_chunks.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace slamsensor::firmware {
namespace {

using std::chrono::milliseconds;
using tests::KeptChunks;

TEST(TapeWriter, WritesEachOperationAsTheFormatSays) {
  KeptChunks kept;
  TapeWriter tape(kept);
  tape.open(HeadLink::PanTiltBytes, {300, true, 9600});
  tape.step(hal::Stamp(1000));
  tape.read(HeadLink::PanTiltBytes, {hal::LinkStatus::Ok, 2, hal::Stamp(999)},
            std::vector<std::uint8_t>{'o', 'k'});
  tape.read(HeadLink::PanTiltBytes, {}, {});
  tape.step(hal::Stamp(2000));
  tape.step(hal::Stamp(2999));
  tape.write(HeadLink::PanTiltBytes, hal::LinkStatus::Busy, std::vector<std::uint8_t>{0xFF});
  tape.can_send(HeadLink::RangefinderCan, hal::LinkStatus::Ok, {.id = 0x605, .size = 1, .data = {0x7F}});
  tape.command(TapeCommand::Hold, 1);
  ASSERT_TRUE(tape.finish());
  const std::vector<std::uint8_t> expected = {
      0x00, 0xAC, 0x02, 0x01, 0x80, 0x4B,  // open link 0: epoch 300, up, 9600
      0x10, 0xE8, 0x07,                    // step at 1000 ns
      0x60, 0x01, 0x02, 'o',  'k',         // read 1 ns before the step
      0x40,                                // busy
      0x10, 0x00,                          // 1000 ns later, as before
      0x10, 0x01,                          // 999 ns later: one less
      0x70, 0x01, 0x01, 0xFF,              // write refused
      0xB3, 0x00, 0x85, 0x0C, 0x02, 0x7F,  // frame to link 3
      0xC0, 0x01, 0x01,                    // hold, reason 1
      0xE0,                                // end
  };
  ASSERT_EQ(kept.chunks.size(), 1U);
  EXPECT_EQ(kept.bytes(0), expected);
}

TEST(TapeWriter, ChunksAreNumberedWholeAndBounded) {
  KeptChunks kept;
  TapeWriter tape(kept);
  const std::vector<std::uint8_t> most(kTapeBytesMax, 7);
  for (int i = 0; i < 50; ++i) {
    tape.step(milliseconds(i));
    tape.read(HeadLink::RangefinderBytes, {hal::LinkStatus::Ok, most.size(), milliseconds(i)}, most);
  }
  ASSERT_TRUE(tape.finish());
  ASSERT_GT(kept.chunks.size(), 10U);
  for (std::size_t i = 0; i < kept.chunks.size(); ++i) {
    EXPECT_EQ(kept.chunks[i].number, i);
    EXPECT_LE(kept.chunks[i].size, kTapeChunkBytes);
    EXPECT_GT(kept.chunks[i].size, 0U);
  }
  EXPECT_EQ(tape.lost(), 0U);
}

TEST(TapeWriter, ReportsALostChunkAtTheStartOfTheNext) {
  KeptChunks kept;
  TapeWriter tape(kept);
  kept.has_room = false;
  const std::vector<std::uint8_t> data(4000, 1);
  std::uint64_t written = 0;
  while (tape.lost() == 0) {
    tape.write(HeadLink::PanTiltBytes, hal::LinkStatus::Ok, data);
    ++written;
  }
  EXPECT_EQ(tape.lost(), written - 1);  // the last one has begun the next chunk
  EXPECT_FALSE(tape.finish());
  EXPECT_FALSE(tape.finish());
  kept.has_room = true;
  ASSERT_TRUE(tape.finish());
  ASSERT_EQ(kept.chunks.size(), 1U);
  EXPECT_EQ(kept.chunks[0].number, 1U);
  EXPECT_EQ(kept.bytes(0)[0], 0xD0);
  EXPECT_EQ(kept.bytes(0)[1], written - 1);
}

TEST(TapeRing, GivesChunksInOrderAndRefusesWhenFull) {
  TapeRing ring(3);
  TapeChunk chunk{};
  for (std::uint64_t i = 0; i < 5; ++i) {
    chunk.number = i;
    chunk.size = static_cast<std::uint32_t>(i);
    chunk.data[0] = static_cast<std::uint8_t>(i);
    EXPECT_EQ(ring.take(chunk), i < 3) << i;
  }
  std::vector<std::uint64_t> numbers;
  ring.drain([&](const TapeChunk& taken) {
    EXPECT_EQ(taken.data[0], taken.number);
    EXPECT_EQ(taken.size, taken.number);
    numbers.push_back(taken.number);
  });
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_TRUE(ring.take(chunk));
}

}  // namespace
}  // namespace slamsensor::firmware
