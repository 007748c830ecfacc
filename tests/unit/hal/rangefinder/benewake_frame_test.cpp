#include "hal/rangefinder/benewake_frame.hpp"

#include "tests/unit/hal/rangefinder/hex.hpp"

#include <gtest/gtest.h>

#include <random>

namespace slamsensor::hal {
namespace {

using tests::hex;
using tests::operator+;
using Bytes = std::vector<std::uint8_t>;

const Bytes kFrame = hex("59 59 D2 04 B0 04 00 00 3C");      // 12.34 m, strength 1200
const Bytes kOverRange = hex("59 59 50 46 0C 00 00 00 54");  // 180 m
const Bytes kReply = hex("5A 06 03 E8 03 4E");

struct Stream {
  RangeCounters counters;
  BenewakeParser parser{counters};
  std::vector<BenewakeReading> readings;
  std::vector<std::uint64_t> ends;
  std::vector<Bytes> replies;

  void push(const Bytes& bytes) {
    for (const std::uint8_t byte : bytes) {
      note(parser.push(byte));
    }
  }
  void pause() { note(parser.pause()); }
  void note(BenewakeParser::Found found) {
    if (found.has_reading) {
      readings.push_back(parser.reading());
      ends.push_back(parser.reading_end());
    }
    if (found.has_reply) {
      replies.emplace_back(parser.reply().begin(), parser.reply().end());
    }
  }
  void push(const Bytes& bytes, int times) {
    for (int i = 0; i < times; ++i) {
      push(bytes);
    }
  }
};

Bytes frame(std::uint16_t distance, std::uint16_t strength, std::uint8_t r0 = 0, std::uint8_t r1 = 0) {
  Bytes out = {0x59,
               0x59,
               static_cast<std::uint8_t>(distance),
               static_cast<std::uint8_t>(distance >> 8),
               static_cast<std::uint8_t>(strength),
               static_cast<std::uint8_t>(strength >> 8),
               r0,
               r1};
  out.push_back(benewake_checksum(out));
  return out;
}

struct Command {
  const char* frame;
  std::uint8_t id;
  const char* payload;
};

// Commands of the TF03 manual.
const Command kCommands[] = {
    {"5A 04 01 5F", 0x01, ""},
    {"5A 04 02 60", 0x02, ""},
    {"5A 06 03 E8 03 4E", 0x03, "E8 03"},
    {"5A 06 03 64 00 C7", 0x03, "64 00"},
    {"5A 06 03 10 27 9A", 0x03, "10 27"},
    {"5A 06 03 00 00 63", 0x03, "00 00"},
    {"5A 04 04 62", 0x04, ""},
    {"5A 05 05 01 65", 0x05, "01"},
    {"5A 08 06 00 C2 01 00 2B", 0x06, "00 C2 01 00"},
    {"5A 08 06 00 10 0E 00 86", 0x06, "00 10 0E 00"},
    {"5A 08 06 40 42 0F 00 F9", 0x06, "40 42 0F 00"},
    {"5A 05 07 01 67", 0x07, "01"},
    {"5A 05 07 00 66", 0x07, "00"},
    {"5A 05 08 01 68", 0x08, "01"},
    {"5A 04 10 6E", 0x10, ""},
    {"5A 04 11 6F", 0x11, ""},
    {"5A 05 10 00 6F", 0x10, "00"},
    {"5A 05 11 00 70", 0x11, "00"},
    {"5A 06 4F 50 46 45", 0x4F, "50 46"},
    {"5A 05 4F 00 AE", 0x4F, "00"},
    {"5A 08 50 03 00 00 00 B5", 0x50, "03 00 00 00"},
    {"5A 08 51 03 30 00 00 E6", 0x51, "03 30 00 00"},
    {"5A 08 52 40 42 0F 00 45", 0x52, "40 42 0F 00"},
    {"5A 05 5D 00 BC", 0x5D, "00"},
    {"5A 05 45 01 A5", 0x45, "01"},
};

TEST(BenewakeFrame, CommandsAreWrittenAndKnownAsTheManualSays) {
  for (const Command& command : kCommands) {
    std::array<std::uint8_t, 16> into{};
    const std::size_t size = write_benewake(command.id, hex(command.payload), into);
    EXPECT_EQ(Bytes(into.begin(), into.begin() + static_cast<std::ptrdiff_t>(size)), hex(command.frame));
    EXPECT_TRUE(is_benewake_command(hex(command.frame)));
    Bytes wrong = hex(command.frame);
    wrong.back() = static_cast<std::uint8_t>(wrong.back() + 1);
    EXPECT_FALSE(is_benewake_command(wrong));
  }
  std::array<std::uint8_t, 16> into{};
  EXPECT_EQ(write_benewake(1, Bytes(13), into), 0u);
  EXPECT_FALSE(is_benewake_command({}));
}

TEST(BenewakeFrame, ExamplesAreRead) {
  Stream stream;
  stream.push(kFrame, 2);
  stream.push(kOverRange, 2);
  EXPECT_EQ(stream.readings.size(), 2u);  // what follows the last is not known yet
  stream.push(kFrame);
  ASSERT_EQ(stream.readings.size(), 3u);  // the first only confirms the second
  EXPECT_EQ(stream.readings[0].distance_cm, 1234);
  EXPECT_EQ(stream.readings[0].strength, 1200);
  EXPECT_EQ(stream.ends[0], 18u);
  EXPECT_EQ(stream.readings[1].distance_cm, 18000);
  EXPECT_EQ(stream.readings[1].strength, 12);
  EXPECT_EQ(stream.ends[1], 27u);
  EXPECT_EQ(stream.ends[2], 36u);
  EXPECT_EQ(stream.counters[RangeEvent::ReadingsWithheld], 1u);
}

TEST(BenewakeFrame, LocksFromEveryByteOfTheStream) {
  Bytes whole;
  for (std::uint16_t i = 0; i < 20; ++i) {
    whole = whole + frame(static_cast<std::uint16_t>(1000 + i), static_cast<std::uint16_t>(700 + 3 * i));
  }
  for (std::size_t from = 0; from < 18; ++from) {
    Stream stream;
    stream.push(Bytes(whole.begin() + static_cast<std::ptrdiff_t>(from), whole.end()));
    EXPECT_GE(stream.readings.size(), 16u) << from;
    for (const BenewakeReading& reading : stream.readings) {
      EXPECT_EQ(reading.strength, 700 + 3 * (reading.distance_cm - 1000)) << from;
    }
  }
}

TEST(BenewakeFrame, BrokenFrameCostsTheLockButNoFalseReading) {
  for (std::size_t at = 0; at < kBenewakeFrame; ++at) {
    Stream stream;
    stream.push(kFrame, 5);
    Bytes broken = kFrame;
    broken[at] = static_cast<std::uint8_t>(broken[at] ^ 0x40);
    stream.push(broken);
    stream.push(kFrame, 5);
    for (const BenewakeReading& reading : stream.readings) {
      EXPECT_EQ(reading.distance_cm, 1234);
      EXPECT_EQ(reading.strength, 1200);
    }
    EXPECT_EQ(stream.counters[RangeEvent::LocksLost], 1u) << at;
    EXPECT_GE(stream.readings.size(), 6u) << at;
  }
}

TEST(BenewakeFrame, LostAndDoubledBytesGiveNoFalseReading) {
  for (std::size_t at = 0; at < kBenewakeFrame; ++at) {
    for (const bool is_doubled : {false, true}) {
      Stream stream;
      stream.push(kFrame, 5);
      Bytes bad = kFrame;
      if (is_doubled) {
        bad.insert(bad.begin() + static_cast<std::ptrdiff_t>(at), bad[at]);
      } else {
        bad.erase(bad.begin() + static_cast<std::ptrdiff_t>(at));
      }
      stream.push(bad);
      stream.push(kFrame, 6);
      for (const BenewakeReading& reading : stream.readings) {
        EXPECT_EQ(reading.distance_cm, 1234) << at;
      }
      EXPECT_GE(stream.readings.size(), 7u);
    }
  }
}

/// `good` with its byte `at` doubled, or left out; of it the nine bytes behind the lock may pass by chance.
Bytes torn(const Bytes& good, std::size_t at, int copies) {
  Bytes bad = good;
  const auto place = bad.begin() + static_cast<std::ptrdiff_t>(at);
  copies == 2 ? void(bad.insert(place, good[at])) : void(bad.erase(place));
  return bad;
}

TEST(BenewakeFrame, ShiftedFrameThatPassesTheChecksumIsNoReading) {
  for (const int copies : {0, 2}) {
    int passed = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Bytes good = frame(static_cast<std::uint16_t>(300 + 7 * i % 12'000),
                               static_cast<std::uint16_t>(40 + 11 * i % 3'000));
      const std::size_t at = static_cast<std::size_t>(i) % kBenewakeFrame;
      const Bytes bytes = torn(good, at, copies) + good;
      const auto first = std::span(bytes).first(kBenewakeFrame);
      const bool passes = first[1] == kBenewakeData && first[0] == kBenewakeData &&
                          benewake_checksum(first.first(kBenewakeFrame - 1)) == first.back();
      // A header within the data is another matter, see below.
      if (!passes || good[2] == kBenewakeData || Bytes(first.begin(), first.end()) == good) {
        continue;
      }
      ++passed;
      Stream stream;
      stream.push(good, 4);
      stream.push(bytes);
      stream.push(good, 4);
      EXPECT_GE(stream.readings.size(), 5u);
      for (const BenewakeReading& reading : stream.readings) {
        EXPECT_EQ(reading.distance_cm, good[2] | good[3] << 8) << i;
        EXPECT_EQ(reading.strength, good[4] | good[5] << 8) << i;
      }
    }
    EXPECT_GT(passed, 10) << copies;
  }
}

TEST(BenewakeFrame, LastFrameBeforeAPauseIsFoundWithIt) {
  Stream stream;
  stream.pause();
  stream.push(kFrame, 3);
  const std::size_t before = stream.readings.size();
  stream.push(kOverRange);
  EXPECT_EQ(stream.readings.size(), before + 1);  // the one before
  stream.pause();
  ASSERT_EQ(stream.readings.size(), before + 2);
  EXPECT_EQ(stream.readings.back().distance_cm, 18000);
  EXPECT_EQ(stream.ends.back(), 36u);
  stream.push({kOverRange.begin(), kOverRange.begin() + 8});
  stream.pause();
  EXPECT_EQ(stream.readings.size(), before + 2);  // half a frame is none
  stream.push({kOverRange.back()});
  stream.pause();
  EXPECT_EQ(stream.readings.size(), before + 3);
}

/// A frame whose data repeat the header, so that also the bytes from the third on pass as a frame.
TEST(BenewakeFrame, HeaderWithinTheDataIsNotFollowed) {
  bool found_one = false;
  for (int strength = 0; strength < 0x10000 && !found_one; strength += 1) {
    const Bytes one = frame(0x5959, static_cast<std::uint16_t>(strength));
    const Bytes three = one + one + one;
    const auto shifted = std::span(three).subspan(2, 9);
    if (benewake_checksum(shifted.first(8)) != shifted[8]) {
      continue;
    }
    found_one = true;
    Stream stream;
    stream.push(Bytes(three.begin() + 2, three.end()), 1);
    stream.push(one, 20);
    EXPECT_TRUE(stream.readings.empty());  // two ways to read it: not delivered
    stream.push(frame(500, 321), 5);
    ASSERT_FALSE(stream.readings.empty());
    for (const BenewakeReading& reading : stream.readings) {
      EXPECT_EQ(reading.distance_cm, 500);
    }
  }
  EXPECT_TRUE(found_one);
}

TEST(BenewakeFrame, RepliesAreFoundBetweenFramesAndAlone) {
  Stream stream;
  stream.push(kReply);
  EXPECT_EQ(stream.replies.size(), 1u);
  stream.push(kFrame, 4);
  stream.push(kReply);
  stream.push(kFrame, 4);
  ASSERT_EQ(stream.replies.size(), 2u);
  EXPECT_EQ(stream.replies[1], kReply);
  EXPECT_EQ(stream.counters[RangeEvent::LocksLost], 0u);
  EXPECT_EQ(stream.readings.size(), 6u);
  stream.push(hex("59 59 5A 04 01 5F"));  // behind half a frame
  EXPECT_EQ(stream.replies.back(), hex("5A 04 01 5F"));
  stream.push(hex("5A FF 01 5F"));  // a length that no reply has
  stream.push(hex("5A 00 01 5F"));
  EXPECT_EQ(stream.replies.size(), 3u);
}

TEST(BenewakeFrame, NoiseGivesNoReading) {
  std::size_t bytes = 0;
  std::size_t readings = 0;
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    std::mt19937 engine(seed);
    Stream stream;
    for (int i = 0; i < 20000; ++i) {
      // One byte in three is the header's.
      stream.push({engine() % 3 == 0 ? std::uint8_t{0x59} : static_cast<std::uint8_t>(engine() & 0xFF)});
      ++bytes;
    }
    readings += stream.readings.size();
  }
  // Two frames in a row by chance: 1/81 * 1/256 twice at each byte.
  EXPECT_LE(readings, 3u) << bytes;
}

}  // namespace
}  // namespace slamsensor::hal
