#include "firmware/lcm/lcm_publisher.hpp"

#include "tests/unit/firmware/lcm/sample_reports.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace slamsensor::firmware {
namespace {

class Tape final : public MessageTap {
 public:
  void published(std::string_view channel, std::span<const std::uint8_t> bytes) noexcept override {
    messages[std::string(channel)].emplace_back(bytes.begin(), bytes.end());
  }
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> messages;
};

/// A publisher on a sink that never opens.
struct Bench {
  explicit Bench(const LcmConfig& config = {})
      : sink(resolve_lcm_url("", nullptr).value()), publisher(LcmPublisher::create(config, sink).value()) {
    sink.set_tap(&tape);
  }
  Tape tape;
  LcmSink sink;
  LcmPublisher publisher;
};

TEST(LcmPublisher, TapHearsEveryMessageEvenWithoutANetwork) {
  Bench bench;
  bench.publisher.publish(tests::sample_report());
  bench.publisher.publish(tests::sample_status(), {});
  const auto landmarks = tests::sample_landmarks(51);
  bench.publisher.publish(tests::view_of(landmarks));
  EXPECT_FALSE(bench.publisher.publish(tests::SampleMap(37).view(), 0, 9));
  bench.publisher.publish(tests::sample_rivals(0));
  bench.publisher.publish(tests::sample_rivals(2));
  const auto& messages = bench.tape.messages;
  ASSERT_EQ(messages.size(), 7U);
  EXPECT_TRUE(decode_lcm<PoseMessage>(messages.at("SLAMSENSOR_POSE").at(0)));
  EXPECT_TRUE(decode_lcm<StatusMessage>(messages.at("SLAMSENSOR_STATUS").at(0)));
  EXPECT_TRUE(decode_lcm<BotCorePose>(messages.at("POSE").at(0)));
  EXPECT_EQ(messages.at("SLAMSENSOR_COUNTERS").size(), 6U);
  EXPECT_EQ(messages.at("SLAMSENSOR_SCAN").size(), 2U);
  EXPECT_EQ(messages.at("SLAMSENSOR_MAP").size(), 2U);
  ASSERT_EQ(messages.at("SLAMSENSOR_RIVALS").size(), 1U);
  EXPECT_TRUE(decode_lcm<RivalsMessage>(messages.at("SLAMSENSOR_RIVALS").at(0)));
  EXPECT_EQ(bench.sink.counters()[1].value, 14U);
}

TEST(LcmPublisher, SendsNoBotCorePoseWithoutAFix) {
  Bench bench;
  FixReport report = tests::sample_report();
  report.fix.status = core::FixStatus::Ambiguous;
  bench.publisher.publish(report);
  EXPECT_EQ(bench.tape.messages.count("POSE"), 0U);
  EXPECT_EQ(bench.tape.messages.count("SLAMSENSOR_POSE"), 1U);
}

TEST(LcmPublisher, TakesItsChannelsFromTheSettings) {
  LcmConfig config;
  config.prefix = "ROVER2_";
  config.bot_core_channel = "";
  Bench bench(config);
  bench.publisher.publish(tests::sample_report());
  ASSERT_EQ(bench.tape.messages.size(), 1U);
  EXPECT_EQ(bench.tape.messages.begin()->first, "ROVER2_POSE");
}

TEST(LcmPublisher, SpreadsALargeMapOverSeveralCalls) {
  Bench bench;
  const tests::SampleMap map(1000);  // 40 chunks
  std::optional<std::uint32_t> next = 0;
  int calls = 0;
  while (next) {
    next = bench.publisher.publish(map.view(), *next, 10);
    ++calls;
  }
  EXPECT_EQ(calls, 4);
  const auto& sent = bench.tape.messages.at("SLAMSENSOR_MAP");
  ASSERT_EQ(sent.size(), 40U);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(decode_lcm<MapMessage>(sent[i]).value().chunk, static_cast<std::int32_t>(i));
  }
  EXPECT_FALSE(bench.publisher.publish(map.view(), 4'000'000'000U, 10));
}

TEST(LcmPublisher, RefusesChannelsThatCannotBe) {
  LcmSink sink(resolve_lcm_url("", nullptr).value());
  LcmConfig config;
  config.prefix = std::string(56, 'x');
  EXPECT_NE(LcmPublisher::create(config, sink).error().message.find("lcm.prefix"), std::string::npos);
  config.prefix = "A B";
  EXPECT_FALSE(LcmPublisher::create(config, sink));
  config.prefix = std::string(55, 'x');
  EXPECT_TRUE(LcmPublisher::create(config, sink));
  config.bot_core_channel = std::string(64, 'x');
  EXPECT_FALSE(LcmPublisher::create(config, sink));
  config = {};
  config.prefix = "";
  EXPECT_EQ(LcmPublisher::create(config, sink).error().message,
            "lcm.bot_core_channel is \"POSE\", which is a channel of lcm.prefix too: change one of them");
}

}  // namespace
}  // namespace slamsensor::firmware
