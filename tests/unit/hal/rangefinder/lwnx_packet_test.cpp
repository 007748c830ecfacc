#include "hal/rangefinder/lwnx_packet.hpp"

#include "hal/rangefinder/lwnx_products.hpp"
#include "tests/unit/hal/rangefinder/hex.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace slamsensor::hal {
namespace {

using tests::bytes_of;
using tests::hex;
using tests::operator+;
using Bytes = std::vector<std::uint8_t>;

struct Seen {
  std::uint8_t id;
  Bytes data;
  std::uint64_t begin;
  std::uint64_t end;
};

std::vector<Seen> parse(LwnxParser& parser, const Bytes& bytes) {
  std::vector<Seen> seen;
  for (const std::uint8_t byte : bytes) {
    parser.push(byte);
    while (const auto packet = parser.next()) {
      seen.push_back({packet->id, {packet->data.begin(), packet->data.end()}, packet->begin, packet->end});
    }
  }
  return seen;
}

void give_up_all(LwnxParser& parser, std::vector<Seen>& seen) {
  while (parser.is_in_packet()) {
    parser.give_up();
    while (const auto packet = parser.next()) {
      seen.push_back({packet->id, {packet->data.begin(), packet->data.end()}, packet->begin, packet->end});
    }
  }
}

struct Example {
  const char* packet;
  std::uint8_t id;
  LwnxAccess access;
  const char* data;
};

// The worked packets of the LW20 serial manual's rules.
const Example kExamples[] = {
    {"AA 40 00 00 70 9F", 0, LwnxAccess::Read, ""},
    {"AA 40 04 00 4C 57 32 30 0 0 0 0 0 0 0 0 0 0 0 0 1C CC", 0, LwnxAccess::Read,
     "4C 57 32 30 0 0 0 0 0 0 0 0 0 0 0 0"},
    {"AA 40 00 0A 3A 3E", 10, LwnxAccess::Read, ""},
    {"AA C1 00 0C 34 12 80 70", 12, LwnxAccess::Write, "34 12"},
    {"AA 41 01 1E 01 00 00 00 FE 8A", 30, LwnxAccess::Write, "1 0 0 0"},
    {"AA 41 01 1E 05 00 00 00 0F 40", 30, LwnxAccess::Write, "5 0 0 0"},
    {"AA 41 01 1E 00 00 00 00 4A FC", 30, LwnxAccess::Write, "0 0 0 0"},
    {"AA 41 01 1B FF 00 00 00 BE 94", 27, LwnxAccess::Write, "FF 0 0 0"},
    {"AA 41 01 1B 11 00 00 00 0E B2", 27, LwnxAccess::Write, "11 0 0 0"},
    {"AA 40 00 2C 9E 7A", 44, LwnxAccess::Read, ""},
    {"AA 40 01 2C D2 04 39 00 E0 2A", 44, LwnxAccess::Read, "D2 04 39 00"},
    {"AA 40 01 2C D2 04 50 00 52 9B", 44, LwnxAccess::Read, "D2 04 50 00"},
    {"AA 00 02 28 03 D2 04 D3 04 FF FF 58 0E", 40, LwnxAccess::Read, "03 D2 04 D3 04 FF FF"},
    {"AA 81 00 5D 08 AD 3E", 93, LwnxAccess::Write, "08"},
    {"AA 81 00 46 01 0D 70", 70, LwnxAccess::Write, "01"},
    {"AA 81 00 5A 07 D5 56", 90, LwnxAccess::Write, "07"},
    {"AA 81 00 32 01 90 B4", 50, LwnxAccess::Write, "01"},
    {"AA 81 00 42 0C 64 6D", 66, LwnxAccess::Write, "0C"},
    {"AA 41 01 4A 32 00 00 00 FF A1", 74, LwnxAccess::Write, "32 0 0 0"},
};

TEST(Crc16, HasTheCheckValueOfXmodem) {
  EXPECT_EQ(crc16_xmodem(bytes_of("123456789")), 0x31C3);
}

TEST(LwnxPacket, ExamplesAreWrittenAsTheManualSays) {
  for (const Example& example : kExamples) {
    std::array<std::uint8_t, 64> into{};
    const std::size_t size = write_lwnx(example.id, example.access, hex(example.data), into);
    EXPECT_EQ(Bytes(into.begin(), into.begin() + static_cast<std::ptrdiff_t>(size)), hex(example.packet));
    EXPECT_EQ(write_lwnx(example.id, example.access, hex(example.data), std::span(into).first(size - 1)), 0u);
  }
}

TEST(LwnxPacket, ExamplesAreReadWhereverTheyStand) {
  for (const Example& example : kExamples) {
    for (const Bytes& before : {Bytes{}, bytes_of("p:LW20,1.6.4\r\n"), hex("AA"), hex("AA 40"),
                                hex("AA AA AA"), hex("00 FF AA 00 00")}) {
      RangeCounters counters;
      LwnxParser parser(counters);
      std::vector<Seen> seen = parse(parser, before + hex(example.packet) + hex(example.packet));
      give_up_all(parser, seen);
      ASSERT_EQ(seen.size(), 2u) << example.packet << " after " << before.size();
      EXPECT_EQ(seen[0].id, example.id);
      EXPECT_EQ(seen[0].data, hex(example.data));
      EXPECT_EQ(seen[0].begin, before.size());
      EXPECT_EQ(seen[0].end, before.size() + hex(example.packet).size());
      EXPECT_EQ(counters[RangeEvent::BytesSkipped], before.size());
    }
  }
}

TEST(LwnxPacket, EveryTruncationAndEveryFlippedBitIsRefused) {
  for (const Example& example : kExamples) {
    const Bytes whole = hex(example.packet);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      RangeCounters counters;
      LwnxParser parser(counters);
      EXPECT_TRUE(
          parse(parser, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))).empty());
    }
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
      Bytes broken = whole;
      broken[bit / 8] = static_cast<std::uint8_t>(broken[bit / 8] ^ (1u << (bit % 8)));
      RangeCounters counters;
      LwnxParser parser(counters);
      std::vector<Seen> seen = parse(parser, broken);
      give_up_all(parser, seen);
      EXPECT_TRUE(seen.empty()) << example.packet << " bit " << bit;
    }
  }
}

TEST(LwnxPacket, PacketsBehindAFalseHeaderAreNotLost) {
  const Bytes packet = hex("AA 40 01 2C D2 04 39 00 E0 2A");
  // A header that claims 1023 bytes of payload, with whole packets inside.
  Bytes stream = hex("AA C0 FF");
  for (int i = 0; i < 150; ++i) {
    stream = stream + packet;
  }
  RangeCounters counters;
  LwnxParser parser(counters);
  const std::vector<Seen> seen = parse(parser, stream);
  EXPECT_EQ(seen.size(), 150u);
  EXPECT_EQ(counters[RangeEvent::ChecksumErrors], 1u);
  EXPECT_EQ(counters[RangeEvent::BytesSkipped], 3u);
}

TEST(LwnxPacket, LengthZeroAndReservedFlagsAreRefusedAtOnce) {
  for (const char* header : {"AA 00 00", "AA 01 00", "AA 42 01", "AA 60 00"}) {
    RangeCounters counters;
    LwnxParser parser(counters);
    EXPECT_EQ(parse(parser, hex(header) + hex("AA 40 00 0A 3A 3E")).size(), 1u) << header;
    EXPECT_EQ(counters[RangeEvent::LengthsRefused], 1u) << header;
  }
}

TEST(LwnxPacket, LongestPacketGoesThrough) {
  const Bytes data(kLwnxPayloadMax - 1, 0xAA);
  Bytes packet(kLwnxPacketMax);
  ASSERT_EQ(write_lwnx(9, LwnxAccess::Write, data, packet), kLwnxPacketMax);
  EXPECT_EQ(write_lwnx(9, LwnxAccess::Write, Bytes(kLwnxPayloadMax), packet), 0u);
  RangeCounters counters;
  LwnxParser parser(counters);
  const auto seen = parse(parser, packet + packet);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[1].data, data);
}

TEST(LwnxPacket, GoodPacketsSurviveAnyNoiseBetweenThem) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    std::mt19937 engine(seed);
    const auto draw = [&](std::uint32_t below) { return engine() % below; };
    Bytes stream;
    std::vector<Bytes> sent;
    for (int i = 0; i < 20; ++i) {
      const auto noise = draw(20);
      for (std::uint32_t n = 0; n < noise; ++n) {
        stream.push_back(draw(4) == 0 ? std::uint8_t{0xAA} : static_cast<std::uint8_t>(draw(256)));
      }
      Bytes data(draw(30));
      for (std::uint8_t& byte : data) {
        byte = static_cast<std::uint8_t>(draw(256));
      }
      Bytes packet(data.size() + 6);
      (void)write_lwnx(static_cast<std::uint8_t>(draw(256)), LwnxAccess::Read, data, packet);
      stream = stream + packet;
      sent.push_back(data);
    }
    RangeCounters counters;
    LwnxParser parser(counters);
    std::vector<Seen> seen = parse(parser, stream);
    give_up_all(parser, seen);
    std::vector<Bytes> got;
    for (const Seen& one : seen) {
      got.push_back(one.data);
    }
    EXPECT_THAT(got, testing::IsSupersetOf(sent)) << "seed " << seed;
  }
}

TEST(LwnxReading, FieldsAreSignedAndSizesMustFit) {
  const LwnxLayout two = {2, 0.01, 2, 1};
  const auto reading = read_lwnx_reading(hex("D2 04 39 00"), two);
  ASSERT_TRUE(reading);
  EXPECT_DOUBLE_EQ(reading->range_m, 12.34);
  EXPECT_DOUBLE_EQ(reading->strength, 57.0);
  EXPECT_DOUBLE_EQ(read_lwnx_reading(hex("FF FF 00 00"), two)->range_m, -0.01);
  EXPECT_FALSE(read_lwnx_reading(hex("D2 04 39"), two));
  EXPECT_FALSE(read_lwnx_reading(hex("D2 04 39 00 00"), two));
  EXPECT_FALSE(read_lwnx_reading({}, two));
  const LwnxLayout four = {4, 0.1, 2, 1};
  EXPECT_DOUBLE_EQ(read_lwnx_reading(hex("F6 FF FF FF 01 00 00 00"), four)->range_m, -1.0);
}

TEST(LwnxReading, RawCountMustAgreeWithTheSize) {
  std::array<Measurement, 8> into{};
  ASSERT_EQ(read_lwnx_raw(hex("03 D2 04 D3 04 FF FF"), into), 3u);
  EXPECT_DOUBLE_EQ(into[1].range_m, 12.35);
  EXPECT_DOUBLE_EQ(into[2].range_m, -0.01);
  EXPECT_EQ(read_lwnx_raw(hex("04 D2 04 D3 04 FF FF"), into), 0u);
  EXPECT_EQ(read_lwnx_raw(hex("02 D2 04 D3 04 FF FF"), into), 0u);
  EXPECT_EQ(read_lwnx_raw({}, into), 0u);
  EXPECT_EQ(read_lwnx_raw(hex("09 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0 1 0"), into), 0u);
}

TEST(LwnxProducts, AreFoundByTheNameThatTheyGive) {
  for (const LwnxProduct& product : lwnx_products()) {
    EXPECT_EQ(find_lwnx_product(product.name), &product);
    EXPECT_EQ(find_lwnx_product(std::string(product.name) + "/X"), &product);
  }
  EXPECT_EQ(find_lwnx_product("BOOT"), nullptr);
  EXPECT_EQ(find_lwnx_product(""), nullptr);
  EXPECT_FALSE(find_lwnx_product("SF40/C")->refused.empty());
}

TEST(LwnxProducts, RatesAreTheManuals) {
  EXPECT_EQ(nearest_rate(*find_lwnx_product("LW20"), 1000.0).code, 8u);
  EXPECT_EQ(nearest_rate(*find_lwnx_product("LW20"), 58.0).code, 2u);
  EXPECT_EQ(nearest_rate(*find_lwnx_product("SF45/B"), 1000.0).code, 7u);
  EXPECT_EQ(nearest_rate(*find_lwnx_product("SF45/B"), 9999.0).code, 12u);
  EXPECT_EQ(nearest_rate(*find_lwnx_product("SF000/B"), 97.0).code, 5u);
  EXPECT_EQ(nearest_rate(*find_lwnx_product("SF30/D"), 78.0).code, 8u);
  EXPECT_EQ(nearest_rate(*find_lwnx_product("GRF-500"), 5.0).code, 50u);
  EXPECT_EQ(nearest_rate(*find_lwnx_product("SF11/C"), 388.0).rate_hz, 20.0);  // its only one
  EXPECT_EQ(nearest_rate(*find_lwnx_product("GRF-500"), 388.0).code, 100u);
}

}  // namespace
}  // namespace slamsensor::hal
