#include "hal/pantilt/ptu_reply.hpp"

#include <gmock/gmock.h>

#include <random>
#include <string>
#include <vector>

namespace slamsensor::hal {
namespace {

struct Told {
  PtuLineKind kind = PtuLineKind::Garbled;
  std::string echo;
  std::string payload;
  PtuMarks marks;
  Stamp begun{};
};

std::vector<Told> parsed(std::string_view bytes) {
  PtuReplyParser parser;
  std::vector<Told> lines;
  Stamp at{};
  for (const char c : bytes) {
    at += Stamp(1);
    if (const auto line = parser.push(static_cast<std::uint8_t>(c), at)) {
      lines.push_back(
          {line->kind, std::string(line->echo), std::string(line->payload), line->marks, line->begun});
    }
  }
  return lines;
}

struct Line {
  const char* bytes;
  PtuLineKind kind;
  const char* echo;
  const char* payload;
  std::uint32_t limits;
};

class OneLine : public testing::TestWithParam<Line> {};

TEST_P(OneLine, IsTakenApart) {
  const std::vector<Told> lines = parsed(GetParam().bytes);
  ASSERT_EQ(lines.size(), 1U) << GetParam().bytes;
  EXPECT_EQ(lines[0].kind, GetParam().kind) << GetParam().bytes;
  EXPECT_EQ(lines[0].echo, GetParam().echo);
  EXPECT_EQ(lines[0].payload, GetParam().payload);
  EXPECT_EQ(lines[0].marks.limits, GetParam().limits);
}

INSTANTIATE_TEST_SUITE_P(
    Manual, OneLine,
    testing::Values(
        Line{"PP * 22\r\n", PtuLineKind::Success, "PP", "22", 0},
        Line{"PP1000 *\r\n", PtuLineKind::Success, "PP1000", "", 0},
        Line{"* -2500\r\n", PtuLineKind::Success, "", "-2500", 0},
        Line{"* -2500\r", PtuLineKind::Success, "", "-2500", 0},
        Line{"* -2500\n", PtuLineKind::Success, "", "-2500", 0},
        Line{"\n*\r\n", PtuLineKind::Success, "", "", 0},
        Line{"\n* 23.142857\r\n", PtuLineKind::Success, "", "23.142857", 0},
        Line{"\n! Illegal Command Entered\r\n", PtuLineKind::Refusal, "", "Illegal Command Entered", 0},
        Line{"\n!T!T*\r\n", PtuLineKind::Success, "", "", 2},
        Line{"!T!T!P!P*\r\n", PtuLineKind::Success, "", "", 4},
        Line{"!P!T* 22\r\n", PtuLineKind::Success, "", "22", 2},
        Line{"* 1!P2\r\n", PtuLineKind::Success, "", "12", 1},
        Line{"P!TP * 22\r\n", PtuLineKind::Success, "PP", "22", 1},
        Line{"! Maximum allowable Pan position is 3090\r\n", PtuLineKind::Refusal, "",
             "Maximum allowable Pan position is 3090", 0},
        Line{"!P! Pan speed cannot exceed 2902 positions/sec\r\n", PtuLineKind::Refusal, "",
             "Pan speed cannot exceed 2902 positions/sec", 1},
        Line{"### PAN-TILT CONTROLLER\r\n", PtuLineKind::Banner, "", "### PAN-TILT CONTROLLER", 0},
        Line{"Initializing...*\r\n", PtuLineKind::Banner, "", "Initializing...*", 0},
        Line{"!T!P\r\n", PtuLineKind::Garbled, "", "", 2}));

INSTANTIATE_TEST_SUITE_P(
    Torn, OneLine,
    testing::Values(Line{" 22\r\n", PtuLineKind::Garbled, "", "22", 0},      // '*' lost
                    Line{"!* 22\r\n", PtuLineKind::Garbled, "", "* 22", 0},  // 'P' of a mark lost
                    Line{"P* 22\r\n", PtuLineKind::Success, "P", "22", 0},   // '!' of a mark lost: no echo
                    Line{"* 22* 23\r\n", PtuLineKind::Success, "", "22* 23", 0}  // end of line lost
                    ));

TEST(PtuReply, CountsEveryKindOfMark) {
  const std::vector<Told> lines = parsed("#P$T!D* 5#T\r");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].payload, "5");
  EXPECT_EQ(lines[0].marks.triggers, 3U);
  EXPECT_EQ(lines[0].marks.cables, 1U);
}

TEST(PtuReply, StampsTheStarAndNotWhatStandsBeforeIt) {
  EXPECT_EQ(parsed("\r\nPP * 22\r\n").at(0).begun, Stamp(6));
  EXPECT_EQ(parsed("!P!T* 22\r\n").at(0).begun, Stamp(5));
}

TEST(PtuReply, DropsWhatIsTooLongAndGoesOnAfterIt) {
  const std::vector<Told> lines = parsed(std::string(5000, '*') + "\r\n* 7\r\n");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].kind, PtuLineKind::Overlong);
  EXPECT_EQ(lines[1].payload, "7");
}

TEST(PtuReply, TakesAnyBytes) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    std::mt19937 engine(seed);
    std::string noise;
    for (int i = 0; i < 2000; ++i) {
      noise += engine() % 3 == 0 ? "!PT*\r\n #"[engine() % 8] : static_cast<char>(engine() & 0xffU);
    }
    for (const Told& line : parsed(noise)) {
      EXPECT_LE(line.echo.size() + line.payload.size(), kPtuLineMax) << "seed " << seed;
    }
    const std::vector<Told> after = parsed(noise + "\r* 42\r");
    EXPECT_EQ(after.back().payload, "42") << "seed " << seed;
  }
}

TEST(PtuNumber, IsTheWholeTextOrNothing) {
  EXPECT_EQ(ptu_number("185.1428"), 185.1428);
  EXPECT_EQ(ptu_number("-2500"), -2500.0);
  EXPECT_EQ(ptu_number("+7"), 7.0);
  EXPECT_EQ(ptu_number("0"), 0.0);
  for (const char* text : {"", "-", "+", ".", "-.5", "1.2.3", "1e5", "nan", "inf", "0x10", "12 ", " 12",
                           "--1", "1234567890123456", "12P", "\xff"}) {
    EXPECT_FALSE(ptu_number(text)) << text;
  }
}

TEST(PtuPosition, IsWhole) {
  EXPECT_EQ(ptu_position("-2500"), -2500);
  EXPECT_FALSE(ptu_position("185.1428"));
  EXPECT_FALSE(ptu_position("2500."));
  EXPECT_FALSE(ptu_position("1000001"));
}

struct Sentence {
  const char* text;
  double value;
  PtuQuantity quantity;
  std::optional<Axis> axis;
};

class Sentences : public testing::TestWithParam<Sentence> {};

TEST_P(Sentences, SayWhatTheyAreAbout) {
  const auto sentence = ptu_sentence(GetParam().text);
  ASSERT_TRUE(sentence) << GetParam().text;
  EXPECT_EQ(sentence->value, GetParam().value);
  EXPECT_EQ(sentence->quantity, GetParam().quantity);
  EXPECT_EQ(sentence->axis, GetParam().axis);
}

INSTANTIATE_TEST_SUITE_P(
    Manual, Sentences,
    testing::Values(
        Sentence{"Current Pan position is 22", 22, PtuQuantity::Position, Axis::Pan},
        Sentence{"Minimum Pan position is -3090", -3090, PtuQuantity::MinPosition, Axis::Pan},
        Sentence{"Minimum Tilt position is -907", -907, PtuQuantity::MinPosition, Axis::Tilt},
        Sentence{"Maximum Tilt position is 604", 604, PtuQuantity::MaxPosition, Axis::Tilt},
        Sentence{"Desired Pan speed is 2000 positions/sec", 2000, PtuQuantity::Speed, Axis::Pan},
        Sentence{"Target Pan speed is 2000 positions/sec", 2000, PtuQuantity::Speed, Axis::Pan},
        Sentence{"Pan acceleration is 2000 positions/sec^2", 2000, PtuQuantity::Acceleration, Axis::Pan},
        Sentence{"Pan acceleration is 2000 positions/sec/sec", 2000, PtuQuantity::Acceleration, Axis::Pan},
        Sentence{"Current Pan base speed is 1000 positions/sec", 1000, PtuQuantity::BaseSpeed, Axis::Pan},
        Sentence{"Base Pan speed is 1000 positions/sec", 1000, PtuQuantity::BaseSpeed, Axis::Pan},
        Sentence{"Maximum Pan speed is 2902 positions/sec", 2902, PtuQuantity::SpeedMax, Axis::Pan},
        Sentence{"Minimum Pan speed is 31 positions/sec", 31, PtuQuantity::SpeedMin, Axis::Pan},
        Sentence{"185.1428 seconds arc per Pan position", 185.1428, PtuQuantity::Resolution, Axis::Pan},
        Sentence{"185.1428 seconds arc per position", 185.1428, PtuQuantity::Resolution, std::nullopt}));

TEST(PtuSentence, OtherTextsAreNoNumbers) {
  for (const char* text :
       {"independent (default) speed control mode", "Unit ID is 0", "Input 30 VDC @ 86 degF",
        "Pan-Tilt Controller v2.12.1d1(C14/E), (C)2003 Directed Perception, Inc.",
        "Limit bounds are ENABLED (soft limits enabled)", "ASCII verbose mode", "22",
        "Current Pan position is", "Current Pan position is 22 or 23", ""}) {
    EXPECT_FALSE(ptu_sentence(text)) << text;
  }
}

}  // namespace
}  // namespace slamsensor::hal
