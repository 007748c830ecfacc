#include "firmware/recording/event_log.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <string>

namespace slamsensor::firmware {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(RecordingMessages, HaveTheFingerprintsOfLcmGen) {
  // The base hashes that lcm-gen 1.3.1 writes for block_t.lcm and text_t.lcm.
  EXPECT_EQ(kBlockFingerprint, std::rotl(std::uint64_t{0xeb7b85f61958f981}, 1));
  EXPECT_EQ(kTextFingerprint, std::rotl(std::uint64_t{0xac2443602189703f}, 1));
}

TEST(RecordingMessages, ABlockIsEncodedAsLcmDoes) {
  const Bytes data = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  Bytes message;
  encode(Block{258, 1, data}, message);
  const Bytes head = {0xD6, 0xF7, 0x0B, 0xEC, 0x32, 0xB1, 0xF3, 0x03, 0,    0,    0,    0,    0, 0, 1, 2,
                      0,    0,    0,    0,    0,    0,    0,    1,    0xCB, 0xF4, 0x39, 0x26, 0, 0, 0, 9};
  ASSERT_EQ(message.size(), head.size() + data.size());
  EXPECT_EQ(Bytes(message.begin(), message.begin() + 32), head);
  const auto block = decode_block(message);
  ASSERT_TRUE(block);
  EXPECT_EQ(block->utime_us, 258);
  EXPECT_EQ(block->number, 1);
  EXPECT_EQ(Bytes(block->data.begin(), block->data.end()), data);
}

TEST(RecordingMessages, ATextHasItsNul) {
  Bytes message;
  encode(Text{-1, "a.b = 1\n"}, message);
  EXPECT_EQ(message.back(), 0);
  EXPECT_EQ(message[23], 9);
  const auto text = decode_text(message);
  ASSERT_TRUE(text);
  EXPECT_EQ(text->utime_us, -1);
  EXPECT_EQ(text->text, "a.b = 1\n");
  encode(Text{0, ""}, message);
  ASSERT_TRUE(decode_text(message));
  EXPECT_EQ(decode_text(message)->text, "");
}

TEST(RecordingMessages, AnyTurnedByteOfTheContentIsNoticed) {
  Bytes block;
  encode(Block{1, 2, Bytes{1, 2, 3}}, block);
  Bytes text;
  encode(Text{1, "text"}, text);
  for (std::size_t i = 0; i < block.size(); ++i) {
    Bytes bad = block;
    bad[i] ^= 0x10U;
    const bool is_time_or_number = i >= 8 && i < 24;  // a wrong number shows as a missing chunk
    EXPECT_EQ(decode_block(bad).has_value(), is_time_or_number) << i;
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    Bytes bad = text;
    bad[i] ^= 0x10U;
    EXPECT_EQ(decode_text(bad).has_value(), i >= 8 && i < 16) << i;
  }
  for (std::size_t size = 0; size < block.size(); ++size) {
    EXPECT_FALSE(decode_block(std::span(block).first(size))) << size;
  }
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_FALSE(decode_text(std::span(text).first(size))) << size;
  }
  EXPECT_FALSE(decode_block(text));
  EXPECT_FALSE(decode_text(block));
}

}  // namespace
}  // namespace slamsensor::firmware
