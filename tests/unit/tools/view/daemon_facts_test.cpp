#include "tools/view/daemon_facts.hpp"

#include <gtest/gtest.h>

#include <array>

namespace slamsensor::tools {
namespace {

firmware::Datum at_latitude(double latitude_deg) {
  firmware::Datum datum;
  datum.latitude_deg = latitude_deg;
  return datum;
}

struct DaemonFactsTest : testing::Test {
  DaemonFactsTest() {
    firmware::PoseMessage pose;
    pose.initialization = 5;
    std::array<std::uint8_t, firmware::kLcmBytes<firmware::PoseMessage>> bytes{};
    EXPECT_NE(firmware::encode_lcm(pose, bytes), 0U);
    story.on_message("SLAMSENSOR_POSE", bytes, 1'000'000);
  }

  SensorStory story{"SLAMSENSOR_"};
  DaemonFacts configured{0, at_latitude(10.0), 600.0};
};

TEST_F(DaemonFactsTest, TheDatumIsThatOfTheDaemonWhoseMessagesAreShown) {
  set_facts(DaemonFacts{5, at_latitude(20.0), 30.0}, configured, story);
  EXPECT_EQ(story.datum()->latitude_deg, 20.0);
  EXPECT_EQ(story.datum_source(), DatumSource::Sensor);
  EXPECT_EQ(story.stale_s(), 30.0);
  set_facts(DaemonFacts{5, std::nullopt, 30.0}, configured, story);
  EXPECT_FALSE(story.datum()) << "the daemon has none, whatever the configuration says";
}

TEST_F(DaemonFactsTest, OfAnotherDaemonOrNoneItIsTheConfigurations) {
  for (const auto& facts :
       {std::optional<DaemonFacts>(), std::optional(DaemonFacts{6, at_latitude(20.0), 30.0})}) {
    set_facts(facts, configured, story);
    EXPECT_EQ(story.datum()->latitude_deg, 10.0);
    EXPECT_EQ(story.datum_source(), DatumSource::Configuration);
    EXPECT_EQ(story.stale_s(), 600.0);
  }
}

TEST(AskFacts, NoneWithoutADaemon) {
  EXPECT_FALSE(ask_facts("/nowhere/control"));
}

}  // namespace
}  // namespace slamsensor::tools
