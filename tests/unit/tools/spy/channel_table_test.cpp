#include "tools/spy/channel_table.hpp"

#include "tests/unit/firmware/lcm/sample_reports.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace slamsensor::tools {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Contains;
using testing::StartsWith;

TEST(ChannelTable, ReportsRatesOverItsWindow) {
  ChannelTable table;
  const std::vector<std::uint8_t> bytes(100);
  EXPECT_EQ(table.rate("A", seconds(1)).messages_hz, 0.0);
  for (int i = 0; i <= 200; ++i) {
    table.add({"A", bytes}, seconds(100) + milliseconds(100 * i));
  }
  const auto rate = table.rate("A", seconds(120));
  EXPECT_NEAR(rate.messages_hz, 10.0, 0.5);
  EXPECT_NEAR(rate.bytes_per_s, 1000.0, 50.0);
  EXPECT_EQ(table.rate("A", seconds(126)).messages_hz, 0.0);
  EXPECT_EQ(table.channels().at("A").messages, 201U);
  EXPECT_EQ(table.channels().at("A").bytes, 20'100U);
}

TEST(ChannelTable, ReportsTheRateOfAYoungChannel) {
  ChannelTable table;
  const std::vector<std::uint8_t> bytes(10);
  for (int i = 0; i < 10; ++i) {
    table.add({"A", bytes}, seconds(50) + milliseconds(100 * i));
  }
  EXPECT_NEAR(table.rate("A", seconds(51)).messages_hz, 10.0, 0.5);
}

TEST(ChannelTable, KeepsWithinItsBounds) {
  ChannelTable table;
  const std::vector<std::uint8_t> bytes(ChannelTable::kKept + 1);
  for (std::size_t i = 0; i < ChannelTable::kChannelsMax + 7; ++i) {
    const std::string name = "channel" + std::to_string(i);
    table.add({name, bytes}, seconds(1));
  }
  EXPECT_EQ(table.channels().size(), ChannelTable::kChannelsMax);
  EXPECT_EQ(table.left_out(), 7U);
  EXPECT_EQ(table.channels().at("channel0").last_message.size(), ChannelTable::kKept);
  EXPECT_EQ(table.channels().at("channel0").last_bytes, ChannelTable::kKept + 1);
}

TEST(KnownTypes, AreFoundByTheirFingerprint) {
  std::array<std::uint8_t, 1400> out{};
  const std::size_t size = firmware::encode_pose(tests::sample_report(), out);
  EXPECT_EQ(lcm_type_text({out.data(), size}), "slamsensor.pose_t");
  const std::vector<std::string> lines = lcm_message_lines({out.data(), size});
  EXPECT_THAT(lines, Contains("x_m                     12.5"));
  EXPECT_THAT(lines, Contains("scan                    4294967290"));
  EXPECT_THAT(lines, Contains(StartsWith("covariance              0.01 0.001 0.0001 0.001 0.02 0.0002 ")));
  EXPECT_TRUE(lcm_message_lines({out.data(), size - 1}).empty());
}

TEST(KnownTypes, ShowTextsAsText) {
  std::array<std::uint8_t, 1400> out{};
  const std::size_t size = firmware::encode_status(tests::sample_status(), {}, out);
  const std::vector<std::string> lines = lcm_message_lines({out.data(), size});
  EXPECT_THAT(lines, Contains("phase                   \"scanning\""));
  EXPECT_THAT(lines, Contains("held                    yes"));
  EXPECT_THAT(lines, Contains("device_model            \"PTU-46-17.5\" \"\""));
}

TEST(KnownTypes, ShowStrangersByTheirNumber) {
  const std::vector<std::uint8_t> stranger = {0xA0, 0x7F, 0xA3, 0xD6, 0x4C, 0xBE, 0xA6, 0xEA, 1, 2};
  EXPECT_EQ(lcm_type_text(stranger), "a07fa3d64cbea6ea");
  EXPECT_TRUE(lcm_message_lines(stranger).empty());
  EXPECT_EQ(lcm_type_text({stranger.data(), 7}), "-");
}

}  // namespace
}  // namespace slamsensor::tools
