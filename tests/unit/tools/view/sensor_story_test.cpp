#include "tools/view/sensor_story.hpp"

#include "core/fix.hpp"
#include "tools/view/story_json.hpp"
#include "tools/view/view_server.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <limits>

namespace slamsensor::tools {
namespace {

class SensorStoryTest : public testing::Test {
 protected:
  template <firmware::LcmMessage T>
  void send(const T& message, std::string_view channel = "SLAMSENSOR_X") {
    std::array<std::uint8_t, firmware::kLcmBytes<T>> bytes{};
    ASSERT_NE(firmware::encode_lcm(message, bytes), 0U);
    story.on_message(channel, bytes, now_us += 1'000'000);
  }

  static firmware::PoseMessage pose(std::int64_t scan, core::FixStatus status = core::FixStatus::Fix,
                                    core::FixReason reason = core::FixReason::None, std::int64_t map = 1) {
    firmware::PoseMessage message;
    message.initialization = 5;
    message.scan = scan;
    message.status = static_cast<std::int8_t>(status);
    message.reason = static_cast<std::int8_t>(reason);
    message.x_m = static_cast<double>(scan);
    message.map = map;
    message.home = 1;
    return message;
  }

  static firmware::ScanMessage scan(std::int64_t number, std::vector<core::Point2> points) {
    firmware::ScanMessage message;
    message.initialization = 5;
    message.scan = number;
    message.landmarks = message.count = static_cast<std::int32_t>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      message.x_m[i] = points[i].x();
      message.y_m[i] = points[i].y();
    }
    return message;
  }

  firmware::PoseMessage local_pose(std::int64_t number, std::int64_t map) {
    return pose(number, core::FixStatus::NoFix, core::FixReason::LocalMap, map);
  }

  SensorStory story{"SLAMSENSOR_"};
  std::int64_t now_us = 1'000'000'000;
};

TEST_F(SensorStoryTest, FixesAreThePathAndAGapBreaksIt) {
  send(pose(0));
  send(pose(1));
  send(pose(1));  // sent again when the devices are back
  send(pose(2, core::FixStatus::Ambiguous, core::FixReason::Symmetric));
  send(pose(3));
  ASSERT_EQ(story.path_W().items.size(), 3U);
  EXPECT_TRUE(story.path_W().items[1].follows);
  EXPECT_FALSE(story.path_W().items[2].follows);
  EXPECT_EQ(story.events().items.size(), 3U) << "a fix, ambiguous, a fix";
}

TEST_F(SensorStoryTest, AnotherHomeMapIsAnotherPath) {
  send(pose(0));
  firmware::PoseMessage other = pose(1);
  other.home = other.map = 2;
  send(other);
  EXPECT_EQ(story.path_W().items.size(), 1U);
  EXPECT_EQ(story.path_W().epoch, 1U);
}

firmware::MapMessage map_chunk(std::int32_t chunk, double x_m) {
  firmware::MapMessage message;
  message.initialization = 5;
  message.landmarks = static_cast<std::int32_t>(firmware::kMapChunkLandmarks) + 1;
  message.chunk = chunk;
  message.chunks = 2;
  message.count = chunk == 0 ? static_cast<std::int32_t>(firmware::kMapChunkLandmarks) : 1;
  message.x_m[0] = x_m;
  message.sigma_m[0] = 0.25;
  return message;
}

TEST_F(SensorStoryTest, OfAMapOnlyWhatHasChangedIsTold) {
  StoryCursor cursor;
  send(map_chunk(0, 1.0));
  send(map_chunk(1, 2.0));
  const nlohmann::json first = story_json(story, now_us, cursor);
  EXPECT_EQ(first["map"]["chunks"], 2);
  EXPECT_EQ(first["map"]["set"].size(), 2U);
  EXPECT_EQ(first["map"]["set"]["1"]["sigma"][0], 0.25);
  send(map_chunk(0, 1.0));
  send(map_chunk(1, 2.0));
  EXPECT_FALSE(story_json(story, now_us, cursor).contains("map")) << "the same again";
  send(map_chunk(0, 1.0));
  send(map_chunk(1, 2.5));
  const nlohmann::json then = story_json(story, now_us, cursor);
  EXPECT_EQ(then["map"]["set"].size(), 1U);
  EXPECT_EQ(then["map"]["set"]["1"]["x"][0], 2.5);
}

TEST_F(SensorStoryTest, MembersThatAreAsBeforeAreNotToldAgain) {
  StoryCursor cursor;
  send(pose(0));
  const nlohmann::json first = story_json(story, now_us, cursor);
  EXPECT_TRUE(first["status"].is_null()) << "there is none: a reader that has one must drop it";
  EXPECT_EQ(first["pose"]["scan"], 0);
  const nlohmann::json then = story_json(story, now_us + 500'000, cursor);
  for (const char* const name : {"pose", "status", "datum", "scan", "rivals", "counters", "local_maps"}) {
    EXPECT_TRUE(first.contains(name)) << name;
    EXPECT_FALSE(then.contains(name)) << name;
  }
  send(pose(1));
  EXPECT_EQ(story_json(story, now_us, cursor)["pose"]["scan"], 1);
}

firmware::RivalsMessage rivals_of(std::int64_t scan) {
  firmware::RivalsMessage message;
  message.initialization = 5;
  message.scan = scan;
  message.count = 3;
  message.x_m = {40.0, std::nan(""), -7.5};
  message.heading_rad = {0.5, 0.0, -1.0};
  message.matches = {9, 8, 7};
  return message;
}

TEST_F(SensorStoryTest, RivalsAreThoseOfTheLastPoseWhileItIsAmbiguous) {
  const auto told = [this] {
    StoryCursor cursor;
    return story_json(story, now_us, cursor)["rivals"];
  };
  send(pose(0));
  send(rivals_of(0));
  EXPECT_TRUE(told().is_null()) << "the pose is a fix";
  send(pose(1, core::FixStatus::Ambiguous, core::FixReason::Symmetric));
  EXPECT_TRUE(told().is_null()) << "they are of another scan";
  send(rivals_of(1));
  ASSERT_EQ(told().size(), 2U) << "one of three has no place";
  EXPECT_EQ(told()[1]["x"], -7.5);
  EXPECT_EQ(told()[1]["heading"], -1.0);
  EXPECT_EQ(told()[1]["matches"], 7);
  send(pose(1, core::FixStatus::NoFix, core::FixReason::Stale));
  EXPECT_TRUE(told().is_null());
}

TEST_F(SensorStoryTest, WithoutAScanThereIsNoAge) {
  StoryCursor cursor;
  send(pose(0, core::FixStatus::NoFix, core::FixReason::NoScan, 0));
  EXPECT_FALSE(story_json(story, now_us, cursor).contains("age_s"));
  firmware::PoseMessage made = pose(1);
  made.scan_end_monotonic_ns = made.report_monotonic_ns = 7;
  send(made);
  EXPECT_EQ(story_json(story, now_us + 2'000'000, cursor)["age_s"], 2.0);
}

TEST_F(SensorStoryTest, ALocalMapGrowsWithPoseAndScanInEitherOrderAndGoesWhenItIsTied) {
  send(scan(4, {{1.0, 0.0}, {0.0, 9.0}}));
  send(local_pose(4, 2));
  ASSERT_EQ(story.local_maps().count(2), 1U);
  EXPECT_EQ(story.local_maps().at(2).landmarks_W, (std::vector<core::Point2>{{5.0, 0.0}, {4.0, 9.0}}));
  send(local_pose(5, 2));
  send(scan(5, {{0.0, 0.0}, {0.0, 20.0}}));
  EXPECT_EQ(story.local_maps().at(2).landmarks_W.size(), 3U) << "one of them is there already";
  firmware::StatusMessage status;
  status.initialization = 5;
  status.local_maps = 1;
  send(status);
  EXPECT_EQ(story.local_maps().size(), 1U);
  send(pose(6));
  status.local_maps = 0;
  send(status);
  EXPECT_TRUE(story.local_maps().empty());
}

TEST_F(SensorStoryTest, MemoryIsBoundedWhateverComes) {
  for (std::int64_t i = 0; i < 12'000; ++i) {
    send(scan(i, {{0.1 * static_cast<double>(i), 3.0}}));
    send(i % 2 == 0 ? pose(i) : local_pose(i, i));
  }
  EXPECT_EQ(story.path_W().items.size(), SensorStory::kPathMax);
  EXPECT_EQ(story.events().items.size(), SensorStory::kEventsMax);
  EXPECT_LE(story.local_maps().size(), SensorStory::kLocalMapsMax);
}

TEST_F(SensorStoryTest, AReaderGetsEachThingOnceAndAllAfterARestart) {
  send(pose(0));
  StoryCursor cursor;
  EXPECT_EQ(story_json(story, now_us, cursor)["path"]["add"].size(), 2U);
  nlohmann::json next = story_json(story, now_us, cursor);
  EXPECT_FALSE(next["path"]["restart"].get<bool>());
  EXPECT_TRUE(next["path"]["add"].empty());
  EXPECT_TRUE(next["events"].empty());
  EXPECT_FALSE(next.contains("map"));
  firmware::PoseMessage again = pose(0);
  again.initialization = 6;
  send(again);
  next = story_json(story, now_us, cursor);
  EXPECT_TRUE(next["path"]["restart"].get<bool>());
  EXPECT_EQ(next["path"]["add"].size(), 2U);
  EXPECT_TRUE(next.contains("map"));
}

TEST_F(SensorStoryTest, NumbersThatAreNoneAreNullInJson) {
  firmware::PoseMessage message = pose(0);
  message.y_m = std::nan("");
  message.covariance.fill(std::numeric_limits<double>::infinity());
  send(message);
  StoryCursor cursor;
  const std::string text = story_json(story, now_us, cursor).dump();
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_TRUE(nlohmann::json::accept(text));
  EXPECT_TRUE(story.path_W().items.empty());
}

TEST_F(SensorStoryTest, OtherChannelsArePassedOver) {
  send(pose(0), "OTHER_POSE");
  EXPECT_FALSE(story.pose());
  EXPECT_FALSE(story.heard_utime_us());
}

TEST(ViewServer, OnlyNamesOfThisMachineAreItsOwn) {
  for (const char* host : {"localhost", "localhost:8210", "127.0.0.1:1", "[::1]:8210", "[::1]"}) {
    EXPECT_TRUE(is_loopback_host(host)) << host;
  }
  for (const char* host :
       {"", "sensor.example", "127.0.0.1.example:80", "localhost.example", "[::2]:80", "[::1]x"}) {
    EXPECT_FALSE(is_loopback_host(host)) << host;
  }
}

TEST(ViewServer, PagesMayAskForNothingThatChangesTheConfiguration) {
  EXPECT_TRUE(is_page_request("scan now"));
  for (const char* request :
       {"config set a b", "map remove x", "map reset", "scan now\nmap reset", "", "map load x"}) {
    EXPECT_FALSE(is_page_request(request)) << request;
  }
}

}  // namespace
}  // namespace slamsensor::tools
