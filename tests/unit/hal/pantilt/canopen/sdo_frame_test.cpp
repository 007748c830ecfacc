#include "hal/pantilt/canopen/canopen_script.hpp"
#include "hal/pantilt/canopen/sdo_client.hpp"
#include "tests/support/scripted_can_link.hpp"

#include <gtest/gtest.h>

namespace slamsensor::hal {
namespace {

using std::chrono::milliseconds;
using tests::can_frame;

TEST(SdoFrame, WritesTheExamples) {
  EXPECT_EQ(sdo_write(1, object::kControlword, 0x0F, 2),
            can_frame(0x601, {0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0}));
  EXPECT_EQ(sdo_write(1, object::kMode, 1, 1), can_frame(0x601, {0x2F, 0x60, 0x60, 0, 1, 0, 0, 0}));
  EXPECT_EQ(sdo_write(1, object::kTarget, static_cast<std::uint32_t>(-25000), 4),
            can_frame(0x601, {0x23, 0x7A, 0x60, 0, 0x58, 0x9E, 0xFF, 0xFF}));
  EXPECT_EQ(sdo_write(1, object::kHeartbeatTime, 100, 2),
            can_frame(0x601, {0x2B, 0x17, 0x10, 0, 0x64, 0, 0, 0}));
  EXPECT_EQ(sdo_read(1, object::kPosition), can_frame(0x601, {0x40, 0x64, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(nmt_frame(NmtCommand::Start, 1), can_frame(0, {1, 1}));
}

TEST(SdoFrame, ReadsTheExamples) {
  const auto value = parse_sdo_reply(can_frame(0x581, {0x43, 0x64, 0x60, 0, 0x40, 0xE2, 1, 0}));
  ASSERT_TRUE(value);
  EXPECT_EQ(value->kind, SdoReplyKind::Value);
  EXPECT_EQ(value->address, object::kPosition);
  EXPECT_EQ(value->value, 123456U);
  const auto abort = parse_sdo_reply(can_frame(0x581, {0x80, 0x64, 0x60, 0, 0, 0, 2, 6}));
  ASSERT_TRUE(abort);
  EXPECT_EQ(sdo_abort_name(abort->value), "object does not exist");
  EXPECT_FALSE(parse_sdo_reply(can_frame(0x581, {0x43, 0x64, 0x60, 0})));
  EXPECT_FALSE(parse_sdo_reply(can_frame(0x581, {0xE0, 0, 0, 0, 0, 0, 0, 0})));
}

struct Client : testing::Test {
  CanRead read(std::initializer_list<int> bytes) { return {LinkStatus::Ok, can_frame(0x581, bytes), now}; }
  tests::ScriptedCanLink link;
  CanopenConfig config;
  CanopenCounters counters{kCanopenEventNames};
  SdoClient client{1, config, link, counters};
  Stamp now = milliseconds(10);
};

TEST_F(Client, TakesNoReplyOfAnotherObject) {
  client.begin(SdoRequest::read(object::kPosition), now);
  client.on_frame(read({0x43, 0x41, 0x60, 0, 1, 0, 0, 0}), now);
  EXPECT_FALSE(client.take());
  EXPECT_EQ(counters[CanopenEvent::SdoRepliesForeign], 1U);
  client.on_frame(read({0x4B, 0x64, 0x60, 0, 0xFE, 0xFF, 0, 0}), now);
  const auto result = client.take();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->signed_value(), -2);
}

TEST_F(Client, ReadsAnotherObjectBeforeItRepeats) {
  client.begin(SdoRequest::read(object::kPosition), now);
  now += config.sdo_timeout;
  client.step(now);
  client.on_frame(read({0x43, 0x64, 0x60, 0, 1, 0, 0, 0}), now);  // late
  EXPECT_FALSE(client.take());
  client.on_frame(read({0x4F, 0x01, 0x10, 0, 0, 0, 0, 0}), now);
  client.on_frame(read({0x43, 0x64, 0x60, 0, 2, 0, 0, 0}), now);
  const auto result = client.take();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->value, 2U);
  const auto sent = link.take_sent();
  ASSERT_EQ(sent.size(), 3U);
  EXPECT_EQ(sent[1], can_frame(0x601, {0x40, 0x01, 0x10, 0, 0, 0, 0, 0}));
}

TEST_F(Client, ReadsANameInSegments) {
  client.begin({SdoRequest::Kind::ReadText, object::kDeviceName, 0, 4}, now);
  client.on_frame(read({0x41, 0x08, 0x10, 0, 9, 0, 0, 0}), now);
  client.on_frame(read({0x00, 'P', 'a', 'n', '-', 'T', 'i', 'l'}), now);
  client.on_frame(read({0x1B, 't', '1', 0, 0, 0, 0, 0}), now);
  ASSERT_TRUE(client.take());
  EXPECT_EQ(client.text().view(), "Pan-Tilt1");
  const auto sent = link.take_sent();
  ASSERT_EQ(sent.size(), 3U);
  EXPECT_EQ(sent[1].data[0], 0x60);
  EXPECT_EQ(sent[2].data[0], 0x70);
}

TEST_F(Client, AbortsASegmentWithAWrongToggle) {
  client.begin({SdoRequest::Kind::ReadText, object::kDeviceName, 0, 4}, now);
  client.on_frame(read({0x41, 0x08, 0x10, 0, 9, 0, 0, 0}), now);
  client.on_frame(read({0x10, 'P', 'a', 'n', '-', 'T', 'i', 'l'}), now);
  const auto result = client.take();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->outcome, SdoOutcome::Aborted);
  EXPECT_EQ(link.take_sent().back(), can_frame(0x601, {0x80, 0x08, 0x10, 0, 0, 0, 0x03, 0x05}));
}

}  // namespace
}  // namespace slamsensor::hal
