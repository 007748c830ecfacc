#include "tests/unit/tools/spy/packets.hpp"
#include "tools/spy/lcm_receiver.hpp"

#include <gtest/gtest.h>

#include <string>

namespace slamsensor::tools {
namespace {

using tests::Bytes;
using tests::FragmentHead;

// The two headers that LCM's description of its protocol gives.
TEST(LcmPacket, ReadsBothHeaders) {
  Bytes bytes = {0x4C, 0x43, 0x30, 0x32, 0, 0, 0, 7, 'P', 'O', 'S', 'E', 0, 0xAB};
  auto packet = parse_lcm_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->sequence, 7U);
  EXPECT_EQ(packet->channel, "POSE");
  ASSERT_EQ(packet->data.size(), 1U);
  EXPECT_EQ(packet->data[0], 0xAB);
  EXPECT_EQ(packet->fragments, 1);

  bytes = {0x4C, 0x43, 0x30, 0x33, 0, 0, 0, 8,   0x00, 0x01, 0x86, 0xA0, 0,
           0,    0,    0,    0,    0, 0, 2, 'M', 0,    1,    2,    3};
  packet = parse_lcm_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->sequence, 8U);
  EXPECT_EQ(packet->message_bytes, 100'000U);
  EXPECT_EQ(packet->offset, 0U);
  EXPECT_EQ(packet->fragment, 0);
  EXPECT_EQ(packet->fragments, 2);
  EXPECT_EQ(packet->channel, "M");
  EXPECT_EQ(packet->data.size(), 3U);
}

TEST(LcmPacket, TakesAnEmptyMessage) {
  const auto packet = parse_lcm_packet(tests::short_packet(1, "A", {}));
  ASSERT_TRUE(packet);
  EXPECT_TRUE(packet->data.empty());
}

TEST(LcmPacket, RefusesChannelsThatDoNotEnd) {
  EXPECT_TRUE(parse_lcm_packet(tests::short_packet(1, std::string(63, 'x'), {})));
  EXPECT_FALSE(parse_lcm_packet(tests::short_packet(1, std::string(64, 'x'), {})));
  EXPECT_FALSE(parse_lcm_packet(tests::short_packet(1, "", Bytes{1, 2})));
  EXPECT_FALSE(parse_lcm_packet(Bytes{'L', 'C', '0', '2', 0, 0, 0, 1, 'A', 'B'}));
}

TEST(LcmPacket, RefusesEveryCut) {
  const Bytes whole = tests::short_packet(1, "AB", {});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(parse_lcm_packet({whole.data(), size})) << size;
  }
  const Bytes fragment = tests::fragment_packet({1, 100, 50, 1, 2}, "", Bytes{1});
  for (std::size_t size = 0; size < fragment.size(); ++size) {
    EXPECT_FALSE(parse_lcm_packet({fragment.data(), size})) << size;
  }
}

// What liblcm 1.3.1 copies beyond its buffer.
TEST(LcmPacket, RefusesFragmentsThatLieAboutTheirPlace) {
  const Bytes data(10, 0xEE);
  const auto is_taken = [&](const FragmentHead& head) {
    return parse_lcm_packet(tests::fragment_packet(head, "A", data)).has_value();
  };
  EXPECT_TRUE(is_taken({1, 100, 90, 1, 2}));
  EXPECT_FALSE(is_taken({1, 100, 91, 1, 2}));
  EXPECT_FALSE(is_taken({1, 100, 101, 1, 2}));
  EXPECT_FALSE(is_taken({1, 100, 0xFFFF'FFFF, 1, 2}));
  EXPECT_FALSE(is_taken({1, 9, 0, 0, 2}));
  EXPECT_FALSE(is_taken({1, 100, 0, 2, 2}));
  EXPECT_FALSE(is_taken({1, 100, 0, 0, 0}));
  EXPECT_TRUE(is_taken({1, static_cast<std::uint32_t>(kLcmMessageMax), 0, 0, 2}));
  EXPECT_FALSE(is_taken({1, static_cast<std::uint32_t>(kLcmMessageMax) + 1, 0, 0, 2}));
}

TEST(LcmPacket, RefusesOtherProtocols) {
  EXPECT_FALSE(parse_lcm_packet({}));
  EXPECT_FALSE(parse_lcm_packet(Bytes(100, 0)));
  EXPECT_FALSE(parse_lcm_packet(Bytes{'L', 'C', '0', '4', 0, 0, 0, 1, 'A', 0}));
}

}  // namespace
}  // namespace slamsensor::tools
