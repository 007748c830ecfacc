#include "tests/unit/tools/spy/packets.hpp"
#include "tools/spy/lcm_receiver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace slamsensor::tools {
namespace {

using tests::Bytes;

Bytes numbered(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  }
  return bytes;
}

std::optional<LcmMessageView> push(LcmReassembler& reassembler, std::uint64_t sender, const Bytes& datagram) {
  const auto packet = parse_lcm_packet(datagram);
  EXPECT_TRUE(packet);
  return packet ? reassembler.push(sender, *packet) : std::nullopt;
}

bool is_equal(const LcmMessageView& message, const Bytes& bytes) {
  return std::equal(message.bytes.begin(), message.bytes.end(), bytes.begin(), bytes.end());
}

TEST(LcmReassembler, PassesShortMessagesOn) {
  LcmReassembler reassembler;
  const Bytes data = numbered(100);
  const Bytes datagram = tests::short_packet(1, "A", data);
  const auto message = push(reassembler, 1, datagram);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->channel, "A");
  EXPECT_TRUE(is_equal(*message, data));
}

// Two senders count their messages from the same number; fragments come in any order, some twice.
TEST(LcmReassembler, PutsMessagesTogetherInAnyOrder) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Bytes first = numbered(10'000);
    const Bytes second = numbered(7'001);
    std::vector<std::pair<std::uint64_t, Bytes>> packets;
    for (const Bytes& packet : tests::fragments_of(5, "FIRST", first, 1000)) {
      packets.emplace_back(1, packet);
    }
    for (const Bytes& packet : tests::fragments_of(5, "SECOND", second, 999)) {
      packets.emplace_back(2, packet);
    }
    packets.push_back(packets[random() % 18]);
    std::shuffle(packets.begin(), packets.end(), random);
    LcmReassembler reassembler;
    int whole = 0;
    for (const auto& [sender, packet] : packets) {
      if (const auto message = push(reassembler, sender, packet)) {
        ++whole;
        EXPECT_EQ(message->channel, sender == 1 ? "FIRST" : "SECOND");
        EXPECT_TRUE(is_equal(*message, sender == 1 ? first : second));
      }
    }
    EXPECT_EQ(whole, 2);
    EXPECT_EQ(reassembler.dropped(), 0U);
  }
}

// A head that promises much costs nothing; what comes is bounded.
TEST(LcmReassembler, KeepsWithinItsBounds) {
  LcmReassembler many;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const tests::FragmentHead head{i, static_cast<std::uint32_t>(kLcmMessageMax), 0, 0, 60'000};
    EXPECT_FALSE(push(many, i % 3, tests::fragment_packet(head, "A", Bytes{1})));
  }
  EXPECT_EQ(many.held_bytes(), LcmReassembler::kSetsMax);
  EXPECT_EQ(many.dropped(), 100U - LcmReassembler::kSetsMax);

  LcmReassembler large;
  const Bytes piece(60'000);
  for (std::uint32_t i = 0; i < 20; ++i) {
    for (std::uint16_t fragment = 0; fragment < 60; ++fragment) {
      const tests::FragmentHead head{i, static_cast<std::uint32_t>(kLcmMessageMax), 60'000U * fragment,
                                     fragment, 70};
      EXPECT_FALSE(push(large, 1, tests::fragment_packet(head, "A", piece)));
      EXPECT_LE(large.held_bytes(), LcmReassembler::kBytesMax);
    }
  }
  EXPECT_GT(large.dropped(), 10U);
}

TEST(LcmReassembler, DropsMessagesWhosePiecesDoNotAddUp) {
  LcmReassembler reassembler;
  EXPECT_FALSE(push(reassembler, 1, tests::fragment_packet({1, 10, 0, 0, 2}, "A", Bytes(4))));
  EXPECT_FALSE(push(reassembler, 1, tests::fragment_packet({1, 10, 4, 1, 2}, "A", Bytes(5))));
  EXPECT_EQ(reassembler.dropped(), 1U);
  EXPECT_FALSE(push(reassembler, 1, tests::fragment_packet({2, 10, 0, 0, 3}, "A", Bytes(6))));
  EXPECT_FALSE(push(reassembler, 1, tests::fragment_packet({2, 10, 5, 1, 3}, "A", Bytes(5))));
  EXPECT_EQ(reassembler.dropped(), 2U);
  EXPECT_EQ(reassembler.held_bytes(), 0U);
}

TEST(LcmReassembler, BeginsAgainWhenTheNumbersDisagree) {
  LcmReassembler reassembler;
  EXPECT_FALSE(push(reassembler, 1, tests::fragment_packet({7, 100, 0, 0, 2}, "OLD", Bytes{1, 2})));
  const Bytes data = numbered(50);
  std::optional<LcmMessageView> message;
  for (const Bytes& packet : tests::fragments_of(7, "NEW", data, 20)) {
    message = push(reassembler, 1, packet);
  }
  ASSERT_TRUE(message);
  EXPECT_EQ(message->channel, "NEW");
  EXPECT_TRUE(is_equal(*message, data));
  EXPECT_EQ(reassembler.dropped(), 1U);
  EXPECT_EQ(reassembler.held_bytes(), 0U);
}

}  // namespace
}  // namespace slamsensor::tools
