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
      const auto found = parser.push(byte);
      if (found.has_reading) {
        readings.push_back(parser.reading());
        ends.push_back(parser.reading_end());
      }
      if (found.has_reply) {
        replies.emplace_back(parser.reply().begin(), parser.reply().end());
      }
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
  EXPECT_EQ(stream.readings.size(), 7u);
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

TEST(BenewakeProduct, CodesOfEveryProductAreNoDistance) {
  struct Row {
    BenewakeModel model;
    BenewakeReading reading;
    Echo echo;
  };
  const std::uint16_t minus_one = 0xFFFF;
  const std::uint16_t minus_two = 0xFFFE;
  const std::uint16_t minus_four = 0xFFFC;
  const Row rows[] = {
      {BenewakeModel::Tf03, {1234, 1200, 0}, Echo::Return},
      {BenewakeModel::Tf03, {1234, 40, 0}, Echo::Return},
      {BenewakeModel::Tf03, {1234, 39, 0}, Echo::Weak},
      {BenewakeModel::Tf03, {18000, 12, 0}, Echo::None},
      {BenewakeModel::Tf03, {18000, 1200, 0}, Echo::None},
      {BenewakeModel::Tf03, {18001, 1200, 0}, Echo::None},
      {BenewakeModel::Tf03, {0, 1200, 0}, Echo::None},
      {BenewakeModel::Tf03, {1234, 3000, 0}, Echo::Saturated},
      {BenewakeModel::TfMini, {minus_one, 10, 0}, Echo::None},
      {BenewakeModel::TfMini, {500, 19, 0}, Echo::Weak},
      {BenewakeModel::TfMini, {500, 20, 0}, Echo::Return},
      {BenewakeModel::TfMiniPlus, {0, 50, 0}, Echo::None},
      {BenewakeModel::TfMiniPlus, {minus_one, 50, 0}, Echo::None},
      {BenewakeModel::TfMiniPlus, {500, 99, 0}, Echo::Weak},
      {BenewakeModel::TfMiniS, {minus_one, 50, 0}, Echo::None},
      {BenewakeModel::TfMiniS, {minus_two, 50, 0}, Echo::Saturated},
      {BenewakeModel::TfMiniS, {minus_four, 50, 0}, Echo::Fault},
      {BenewakeModel::TfMiniS, {0x8000, 500, 0}, Echo::Fault},
      {BenewakeModel::Tf02, {500, 500, 7}, Echo::Return},
      {BenewakeModel::Tf02, {500, 500, 8}, Echo::Return},
      {BenewakeModel::Tf02, {500, 500, 6}, Echo::Weak},
      {BenewakeModel::Tf02, {minus_one, 500, 8}, Echo::None},
  };
  for (const Row& row : rows) {
    const BenewakeProduct& product = benewake_product(row.model);
    const RangeConfig range = {
        .range_max_m = 400.0, .weak_below = product.weak_below, .saturated_from = 3000.0};
    const std::uint16_t over_range = row.model == BenewakeModel::Tf03 ? 18000 : 0;
    const Measurement out = judged(measured(row.reading, product, over_range), Strength::Known, range);
    EXPECT_EQ(out.echo, row.echo) << product.name << " " << row.reading.distance_cm << " "
                                  << row.reading.strength;
    EXPECT_EQ(out.range_m > 0.0, row.echo == Echo::Return);
  }
}

}  // namespace
}  // namespace slamsensor::hal
