#include "tests/unit/tools/recording/made_tape.hpp"
#include "tools/recording/playback.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string_view>

namespace slamsensor::tools {
namespace {

using firmware::HeadLink;
using firmware::TapeOp;
using firmware::TapeWriter;
using hal::LinkStatus;
using std::chrono::milliseconds;
using testing::HasSubstr;

std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

/// One line that comes up, is asked, answers, and goes down.
void write_dialogue(TapeWriter& tape) {
  tape.open(HeadLink::PanTiltBytes, {0, false, 9600});
  tape.step(milliseconds(1));
  tape.service(HeadLink::PanTiltBytes, {1, true, 9600});
  tape.set_baud(HeadLink::PanTiltBytes, LinkStatus::Ok, 19'200);
  tape.after(HeadLink::PanTiltBytes, {1, true, 19'200});
  tape.write(HeadLink::PanTiltBytes, LinkStatus::Ok, bytes_of("PP "));
  tape.step(milliseconds(2));
  tape.read(HeadLink::PanTiltBytes, {LinkStatus::Ok, 4, milliseconds(2)}, bytes_of("* 22"));
  tape.read(HeadLink::PanTiltBytes, {LinkStatus::Down, 0, {}}, {});
  tape.after(HeadLink::PanTiltBytes, {1, false, 19'200});
}

/// The first step of the dialogue, as the driver did it.
void do_first_step(TapePlayer& player, hal::ByteLink& line) {
  const auto step = player.next();
  ASSERT_TRUE(step);
  EXPECT_EQ(step->time, milliseconds(1));
  EXPECT_FALSE(line.is_up());
  line.service(step->time);
  EXPECT_TRUE(line.is_up());
  EXPECT_EQ(line.epoch(), 1U);
  EXPECT_EQ(line.set_baud(19'200), LinkStatus::Ok);
  EXPECT_EQ(line.baud(), 19'200U);
}

TEST(TapePlayer, PlaysADialogueToItsEnd) {
  tests::MadeTape tape(write_dialogue);
  TapePlayer player(tape);
  const auto links = playback_links(player);
  ASSERT_NE(links.pan_tilt_bytes, nullptr);
  EXPECT_EQ(links.pan_tilt_can, nullptr);
  EXPECT_EQ(links.rangefinder_bytes, nullptr);
  hal::ByteLink& line = *links.pan_tilt_bytes;
  do_first_step(player, line);
  EXPECT_EQ(line.write(bytes_of("PP ")), LinkStatus::Ok);
  EXPECT_TRUE(player.has_ended_step());
  ASSERT_TRUE(player.next());
  line.service(milliseconds(2));
  std::array<std::uint8_t, 8> bytes{};
  const hal::ByteRead read = line.read(bytes);
  EXPECT_EQ(read.count, 4U);
  EXPECT_EQ(read.stamp, milliseconds(2));
  EXPECT_EQ(bytes[2], '2');
  EXPECT_FALSE(player.has_ended_step());
  EXPECT_EQ(line.read(bytes).status, LinkStatus::Down);
  EXPECT_FALSE(line.is_up());
  EXPECT_TRUE(player.has_ended_step());
  EXPECT_FALSE(player.next());
  EXPECT_EQ(player.end(), TapeEnd::Complete);
}

TEST(TapePlayer, OtherBytesAreADivergenceWithBothAndItsPlace) {
  tests::MadeTape tape(write_dialogue);
  TapePlayer player(tape);
  const auto links = playback_links(player);
  do_first_step(player, *links.pan_tilt_bytes);
  EXPECT_EQ(links.pan_tilt_bytes->write(bytes_of("TP ")), LinkStatus::Busy);
  EXPECT_EQ(player.end(), TapeEnd::Diverged);
  EXPECT_THAT(player.end_text(),
              testing::AllOf(HasSubstr("'TP '"), HasSubstr("'PP '"), HasSubstr("pan-tilt port"),
                             HasSubstr("at 0.001 s (chunk 0, operation 6)")));
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(links.pan_tilt_bytes->read(bytes).status, LinkStatus::Busy);
  EXPECT_FALSE(player.has_ended_step());
  EXPECT_FALSE(player.next());
}

TEST(TapePlayer, AnotherCallIsADivergence) {
  tests::MadeTape tape(write_dialogue);
  TapePlayer player(tape);
  const auto links = playback_links(player);
  do_first_step(player, *links.pan_tilt_bytes);
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_EQ(links.pan_tilt_bytes->read(bytes).status, LinkStatus::Busy);
  EXPECT_EQ(player.end(), TapeEnd::Diverged);
  EXPECT_THAT(player.end_text(), HasSubstr("a read of the pan-tilt port, the tape has a write"));
}

TEST(TapePlayer, ACallThatIsLeftOutIsADivergence) {
  tests::MadeTape tape(write_dialogue);
  TapePlayer player(tape);
  const auto links = playback_links(player);
  do_first_step(player, *links.pan_tilt_bytes);
  EXPECT_FALSE(player.has_ended_step());
  EXPECT_FALSE(player.next());
  EXPECT_EQ(player.end(), TapeEnd::Diverged);
  EXPECT_THAT(player.end_text(), HasSubstr("the tape has a write of 'PP '"));
}

TEST(TapePlayer, AReadWithTooLittleRoomIsADivergenceNotAnOverrun) {
  tests::MadeTape tape([](TapeWriter& writer) {
    writer.open(HeadLink::RangefinderBytes, {1, true, 9600});
    writer.step(milliseconds(1));
    writer.read(HeadLink::RangefinderBytes, {LinkStatus::Ok, 4, {}}, bytes_of("abcd"));
  });
  TapePlayer player(tape);
  const auto links = playback_links(player);
  ASSERT_TRUE(player.next());
  std::array<std::uint8_t, 3> bytes{};
  EXPECT_EQ(links.rangefinder_bytes->read(bytes).count, 0U);
  EXPECT_EQ(player.end(), TapeEnd::Diverged);
}

TEST(TapePlayer, FramesAreHeldAgainstTheTape) {
  const hal::CanFrame frame{.id = 0x601, .size = 2, .data = {0x40, 0x18}};
  tests::MadeTape tape([&](TapeWriter& writer) {
    writer.open(HeadLink::PanTiltCan, {1, true, 0});
    writer.step(milliseconds(1));
    writer.can_receive(HeadLink::PanTiltCan, {LinkStatus::Ok, frame, milliseconds(1)});
    writer.can_send(HeadLink::PanTiltCan, LinkStatus::Ok, frame);
    writer.can_send(HeadLink::PanTiltCan, LinkStatus::Ok, frame);
  });
  TapePlayer player(tape);
  const auto links = playback_links(player);
  ASSERT_TRUE(player.next());
  EXPECT_EQ(links.pan_tilt_can->receive().frame, frame);
  EXPECT_EQ(links.pan_tilt_can->send(frame), LinkStatus::Ok);
  hal::CanFrame other = frame;
  other.data[1] = 0x19;
  EXPECT_EQ(links.pan_tilt_can->send(other), LinkStatus::Busy);
  EXPECT_THAT(player.end_text(), testing::AllOf(HasSubstr("identifier 1537 and bytes 40 19"),
                                                HasSubstr("identifier 1537 and bytes 40 18")));
}

void write_many_steps(TapeWriter& tape) {
  for (int i = 0; i < 200'000; ++i) {
    tape.step(milliseconds(i));
  }
}

struct Damage {
  const char* name;
  void (*damage)(std::vector<firmware::TapeChunk>& chunks);
  TapeEnd end;
  const char* text;
};

class DamagedTape : public testing::TestWithParam<Damage> {};

TEST_P(DamagedTape, PlaysAsFarAsItIsGoodAndSaysWhy) {
  tests::MadeTape tape(write_many_steps);
  ASSERT_GT(tape.chunks().size(), 5U);
  GetParam().damage(tape.chunks());
  TapePlayer player(tape);
  std::size_t steps = 0;
  hal::Stamp last{};
  while (const auto step = player.next()) {
    EXPECT_EQ(step->time, milliseconds(steps));
    last = step->time;
    ++steps;
  }
  EXPECT_GT(steps, 10'000U);
  EXPECT_LT(steps, 200'000U);
  EXPECT_EQ(player.end(), GetParam().end);
  EXPECT_THAT(player.end_text(), HasSubstr(GetParam().text));
  EXPECT_EQ(player.now(), last);
}

INSTANTIATE_TEST_SUITE_P(
    Damages, DamagedTape,
    testing::Values(Damage{"cut", [](auto& chunks) { chunks.resize(3); }, TapeEnd::Cut, "was not ended"},
                    Damage{"missing", [](auto& chunks) { chunks.erase(chunks.begin() + 2); },
                           TapeEnd::ChunkMissing, "chunk 2 is missing or damaged, chunk 3 follows"},
                    Damage{"broken", [](auto& chunks) { chunks[2].data[100] = 0xF0; }, TapeEnd::Broken,
                           "is no operation"},
                    Damage{"another", [](auto& chunks) { chunks[3].number = 0; }, TapeEnd::Cut,
                           "another recording begins"},
                    Damage{"lost", [](auto& chunks) { chunks[2].data[0] = 0xD0; }, TapeEnd::Lost,
                           "the recorder lost"}),
    [](const auto& damage) { return damage.param.name; });

}  // namespace
}  // namespace slamsensor::tools
