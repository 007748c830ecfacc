#include "tests/unit/tools/recording/made_tape.hpp"
#include "tools/recording/playback.hpp"
#include "tools/world/random.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace slamsensor::tools {
namespace {

using firmware::HeadLink;
using firmware::TapeOp;
using firmware::TapeWriter;
using hal::LinkStatus;

constexpr hal::Stamp kBoot = std::chrono::hours(1000);

void write_one_of_each(TapeWriter& tape) {
  const std::vector<std::uint8_t> bytes = {1, 2, 255};
  const hal::CanFrame frame{.id = 0x1FFF'FFFF, .extended = true, .size = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
  tape.open(HeadLink::PanTiltCan, {4'294'967'295, false, 0});
  tape.step(kBoot);
  tape.service(HeadLink::PanTiltCan, {5, true, 0});
  tape.after(HeadLink::RangefinderBytes, {6, false, 921'600});
  tape.read(HeadLink::RangefinderBytes, {LinkStatus::Ok, 3, kBoot + hal::Stamp(7)}, bytes);
  tape.write(HeadLink::RangefinderBytes, LinkStatus::Down, bytes);
  tape.set_baud(HeadLink::RangefinderBytes, LinkStatus::Ok, 4'000'000);
  tape.discard(HeadLink::RangefinderBytes);
  tape.can_receive(HeadLink::PanTiltCan, {LinkStatus::Ok, frame, kBoot - hal::Stamp(7)});
  tape.can_receive(HeadLink::PanTiltCan, {LinkStatus::Down, {}, {}});
  tape.can_send(HeadLink::PanTiltCan, LinkStatus::Busy, frame);
  tape.command(firmware::TapeCommand::SetMode, 2);
}

std::vector<TapeOperation> read_all(TapeReader& reader) {
  std::vector<TapeOperation> operations;
  while (const auto operation = reader.next()) {
    operations.push_back(*operation);
  }
  return operations;
}

TEST(TapeReader, ReadsBackEachOperation) {
  tests::MadeTape tape(write_one_of_each);
  TapeReader reader;
  reader.load(tape.chunks().at(0).bytes());
  const auto operations = read_all(reader);
  EXPECT_FALSE(reader.is_broken());
  ASSERT_EQ(operations.size(), 13U);
  EXPECT_EQ(operations[0].op, TapeOp::Open);
  EXPECT_EQ(operations[0].state, (firmware::TapeLinkState{4'294'967'295, false, 0}));
  EXPECT_EQ(operations[1].time, kBoot);
  EXPECT_EQ(operations[2].op, TapeOp::Service);
  EXPECT_TRUE(operations[2].state.is_up);
  EXPECT_EQ(operations[3].state.baud, 921'600U);
  EXPECT_EQ(operations[4].time, kBoot + hal::Stamp(7));
  EXPECT_EQ(operations[4].bytes[2], 255);
  EXPECT_EQ(operations[5].status, LinkStatus::Down);
  EXPECT_EQ(operations[5].link, HeadLink::RangefinderBytes);
  EXPECT_EQ(operations[6].baud, 4'000'000U);
  EXPECT_EQ(operations[7].op, TapeOp::Discard);
  EXPECT_EQ(operations[8].time, kBoot - hal::Stamp(7));
  EXPECT_EQ(operations[8].frame.id, 0x1FFF'FFFFU);
  EXPECT_TRUE(operations[8].frame.extended);
  EXPECT_EQ(operations[8].frame.data[7], 8);
  EXPECT_EQ(operations[9].op, TapeOp::ReadDown);
  EXPECT_EQ(operations[10].status, LinkStatus::Busy);
  EXPECT_EQ(operations[11].command, firmware::TapeCommand::SetMode);
  EXPECT_EQ(operations[11].number, 2U);
  EXPECT_EQ(operations[12].op, TapeOp::End);
}

TEST(TapeReader, TimesOfStepsAreExactWhateverTheirRhythm) {
  constexpr std::uint64_t kSeed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Random rng(kSeed);
  std::vector<hal::Stamp> times = {kBoot};
  for (int i = 0; i < 40'000; ++i) {
    times.push_back(times.back() + hal::Stamp(static_cast<std::int64_t>(draw_uniform(rng, 0.0, 3e6))));
  }
  tests::MadeTape tape([&](TapeWriter& writer) {
    for (const hal::Stamp time : times) {
      writer.step(time);
    }
  });
  EXPECT_GT(tape.chunks().size(), 3U);
  TapeReader reader;
  std::vector<hal::Stamp> read;
  while (const auto chunk = tape.next()) {
    reader.load(chunk->bytes);
    for (const TapeOperation& operation : read_all(reader)) {
      if (operation.op == TapeOp::Step) {
        read.push_back(operation.time);
      }
    }
    EXPECT_FALSE(reader.is_broken());
  }
  EXPECT_EQ(read, times);
}

TEST(TapeReader, ACutChunkGivesItsWholeOperationsAndIsReportedBroken) {
  tests::MadeTape tape(write_one_of_each);
  const auto whole = tape.chunks().at(0).bytes();
  std::size_t last = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    TapeReader cut;
    cut.load(whole.first(size));
    const std::size_t count = read_all(cut).size();
    EXPECT_GE(count, last);
    EXPECT_LE(count, 12U);
    last = count;
  }
  EXPECT_EQ(last, 12U);
}

TEST(TapeReader, RefusesNumbersBeyondTheirBounds) {
  const std::vector<std::vector<std::uint8_t>> broken = {
      {0xF0},                                                              // no such operation
      {0x14, 0x00},                                                        // no such link
      {0x60, 0x00, 0x05, 'a'},                                             // more bytes than there are
      {0x60, 0x00, 0x81, 0x40},                                            // 8193 bytes
      {0x70, 0x03, 0x00},                                                  // no such status
      {0xA1, 0x00, 0x01, 0x12, 1, 2, 3, 4, 5, 6, 7, 8, 9},                 // a frame of nine bytes
      {0xC0, 0x06, 0x00},                                                  // no such command
      {0x00, 0x00, 0x02, 0x00},                                            // neither up nor down
      {0x80, 0x00, 0x80, 0x80, 0x80, 0x80, 0x10},                          // 2^32 baud
      {0x10, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02},  // more than 64 bits
      {0x10, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x01},  // a time that overflows
      {0x10, 0x80},                                                        // no end
      {0x10, 0x05, 0x10, 0x0D},                                            // a step back in time
  };
  for (const auto& bytes : broken) {
    TapeReader reader;
    reader.load(bytes);
    EXPECT_LE(read_all(reader).size(), 1U);
    EXPECT_TRUE(reader.is_broken()) << testing::PrintToString(bytes);
    EXPECT_FALSE(reader.next());
  }
}

}  // namespace
}  // namespace slamsensor::tools
