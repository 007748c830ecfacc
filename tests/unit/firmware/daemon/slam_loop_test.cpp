#include "firmware/daemon/slam_loop.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace slamsensor::firmware {
namespace {

using std::chrono::seconds;

constexpr hal::Stamp kNow = seconds(100);
constexpr double kPostRadius_m = 0.3;
// No two triangles of them are alike.
constexpr double kPosts_W[][2] = {{9, 2},  {14, -5}, {6, -9},  {21, 4},  {17, 13},  {-4, 12}, {3, 18},
                                  {-2, 7}, {26, -9}, {12, 24}, {-9, -6}, {11, -17}, {30, 9},  {-13, 4}};

hal::Stamp clock_now(void*) noexcept {
  return kNow;
}

/// A place whose posts stand as in a mirror: no pose explains them by those of the other.
enum class Place { Posts, Mirrored };

/// The scanline that a sensor at `x_m` on the x axis, looking along it, sweeps past the posts.
std::vector<core::Reading> sweep_from(double x_m, Place place) {
  const double side = place == Place::Posts ? 1.0 : -1.0;
  std::vector<core::Reading> readings;
  for (double pan_deg = -179.0; pan_deg < 179.0; pan_deg += 0.05) {
    core::Reading reading{pan_deg * core::kDegree, 0.0, core::Reading::kNoReturn};
    for (const auto& post : kPosts_W) {
      const double dx = post[0] - x_m;
      const double dy = side * post[1];
      const double along = dx * std::cos(reading.pan_rad) + dy * std::sin(reading.pan_rad);
      const double across = dy * std::cos(reading.pan_rad) - dx * std::sin(reading.pan_rad);
      const bool is_hit = along > 0.0 && std::abs(across) < kPostRadius_m;
      if (is_hit && (!reading.has_return() || along < reading.range_m)) {
        reading.range_m = along;
      }
    }
    readings.push_back(reading);
  }
  return readings;
}

class SlamLoopTest : public testing::Test {
 protected:
  /// Scans at `x_m`, and gives what the loop sends.
  std::optional<FixMessage> scan_at(double x_m, Place place = Place::Posts) {
    const std::vector<core::Reading> readings = sweep_from(x_m, place);
    queue.push(ScanBegun{});
    for (std::uint32_t line = 0; line < 3; ++line) {
      Scanline scanline;
      scanline.readings = readings;
      scanline.line = line;
      EXPECT_TRUE(queue.push(scanline));
      run();
    }
    queue.push(ScanEnded{
        .begin = kNow - seconds(3), .middle = kNow - seconds(2), .end = kNow, .lines = 3, .known = kNow});
    run();
    FixMessage message;
    return outlets.fixes.pop(message) ? std::optional(message) : std::nullopt;
  }

  void run() {
    while (loop.step({clock_now, seconds(1000), &is_stopping})) {
    }
  }

  /// Of the newest map, which is copied for it.
  std::uint64_t revision() {
    outlets.map.ask();
    run();
    EXPECT_EQ(outlets.map.copied(), outlets.map.revision());
    return outlets.map.read([](const MapSnapshot& map) { return map.revision(); });
  }

  Config config;
  ScanQueue queue{8, 120'000};
  SlamOrders orders;
  SlamOutlets outlets{config.core.capacities};
  std::atomic<bool> is_stopping{false};
  SlamLoop loop{config, queue, orders, outlets};
};

TEST_F(SlamLoopTest, SendsAFixForEachScan) {
  ASSERT_TRUE(scan_at(0.0));
  const auto second = scan_at(2.0);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->fix.status, core::FixStatus::Fix);
  EXPECT_NEAR(second->fix.pose_W.x_m, 2.0, 0.2);
  EXPECT_EQ(second->fix.time.end_utc, kNow + seconds(1000));
  EXPECT_EQ(second->scan_ended, kNow);
  EXPECT_GT(second->seen().size(), 8U);
  EXPECT_EQ(loop.slam().revision(), revision());
}

TEST_F(SlamLoopTest, CopiesTheMapWhenAskedAndAtItsEndAlone) {
  ASSERT_TRUE(scan_at(0.0));
  EXPECT_GT(outlets.map.revision(), 0U);
  EXPECT_EQ(outlets.map.copied(), 0U) << "nobody asked";
  ASSERT_TRUE(outlets.map.try_read([](const MapSnapshot& map) { EXPECT_TRUE(map.empty()); }));
  const std::uint64_t first = revision();
  ASSERT_TRUE(scan_at(2.0));
  EXPECT_GT(outlets.map.revision(), first);
  EXPECT_EQ(outlets.map.copied(), first);
  loop.end();
  EXPECT_EQ(outlets.map.copied(), outlets.map.revision());
  outlets.map.ask();
  EXPECT_FALSE(outlets.map.is_asked()) << "there is no newer one";
  outlets.map.read([&](const MapSnapshot& map) { EXPECT_EQ(map.revision(), loop.slam().revision()); });
}

// A busy SLAM thread is never idle: then the map is copied when a scan's fix was sent.
TEST_F(SlamLoopTest, AMapAskedForDuringAScanComesAfterItsFix) {
  ASSERT_TRUE(scan_at(0.0));
  outlets.map.ask();
  ASSERT_TRUE(outlets.map.is_asked());
  EXPECT_FALSE(outlets.map.try_read([](const MapSnapshot&) { FAIL() << "it is being made"; }));
  const auto readings = sweep_from(2.0, Place::Posts);
  Scanline scanline;
  scanline.readings = readings;
  ASSERT_TRUE(queue.push(scanline));
  ASSERT_TRUE(queue.push(ScanEnded{
      .begin = kNow - seconds(3), .middle = kNow - seconds(2), .end = kNow, .lines = 1, .known = kNow}));
  ASSERT_TRUE(loop.step({clock_now, seconds(1000), &is_stopping}));
  EXPECT_TRUE(outlets.map.is_asked());
  ASSERT_TRUE(loop.step({clock_now, seconds(1000), &is_stopping}));
  EXPECT_FALSE(outlets.map.is_asked());
  EXPECT_EQ(outlets.map.copied(), outlets.map.revision());
}

// An older map is better than none, and the one that is not answered may not write into what is read.
TEST_F(SlamLoopTest, AReaderThatIsNotAnsweredGetsTheOlderMap) {
  ASSERT_TRUE(scan_at(0.0));
  const std::uint64_t first = revision();
  ASSERT_TRUE(scan_at(2.0));
  outlets.map.read([&](const MapSnapshot& map) {
    EXPECT_EQ(map.revision(), first);
    EXPECT_FALSE(outlets.map.claim());
    EXPECT_FALSE(outlets.map.is_asked());
  });
}

TEST_F(SlamLoopTest, AStopEndsASearchAndItsScanHasNoResult) {
  ASSERT_TRUE(scan_at(0.0));
  const std::uint64_t before = revision();
  is_stopping = true;
  EXPECT_FALSE(scan_at(2.0));
  EXPECT_EQ(revision(), before);
  is_stopping = false;
  const auto next = scan_at(2.0);
  ASSERT_TRUE(next);
  // The scan that was cut may have been kept in a local map, so that this one is not the next of a row of
  // scans.
  EXPECT_NE(next->fix.status, core::FixStatus::NoFix);
  EXPECT_NEAR(next->fix.pose_W.x_m, 2.0, 0.2);
}

TEST_F(SlamLoopTest, OrdersComeBeforeScansAndAreAnswered) {
  ASSERT_TRUE(scan_at(0.0));
  ASSERT_TRUE(orders.give({MapCommand::Freeze, {}}));
  EXPECT_FALSE(orders.give({MapCommand::Reset, {}})) << "one at a time";
  EXPECT_FALSE(orders.answer());
  run();
  const auto frozen = orders.answer();
  ASSERT_TRUE(frozen);
  EXPECT_EQ(frozen->scans, 1U);
  EXPECT_FALSE(orders.answer()) << "an answer is given once";

  const std::uint64_t before = revision();
  ASSERT_TRUE(scan_at(2.0));
  EXPECT_EQ(revision(), before) << "a frozen map does not change";
  ASSERT_TRUE(outlets.status.refresh());
  EXPECT_TRUE(outlets.status.value().frozen);

  ASSERT_TRUE(orders.give({MapCommand::Reset, {}}));
  run();
  ASSERT_TRUE(orders.answer());
  ASSERT_TRUE(outlets.status.refresh());
  EXPECT_EQ(outlets.status.value().landmarks, 0U);
}

TEST_F(SlamLoopTest, AMapMarkedFrozenIsFrozenBeforeTheNextScan) {
  ASSERT_TRUE(scan_at(0.0));
  ASSERT_GT(revision(), 0U);
  // What a Restore points to stays until it is answered.
  const MapSnapshot kept = outlets.map.read([](const MapSnapshot& map) { return map; });
  ASSERT_TRUE(orders.give({.kind = MapCommand::Restore, .state = kept.state(), .frozen = core::Frozen::Yes}));
  run();
  ASSERT_TRUE(orders.answer());
  const std::uint64_t before = revision();
  ASSERT_TRUE(scan_at(2.0));
  EXPECT_EQ(revision(), before);
  ASSERT_TRUE(outlets.status.refresh());
  EXPECT_TRUE(outlets.status.value().frozen);
}

TEST_F(SlamLoopTest, ScansElsewhereAreALocalMapThatTheStatusCounts) {
  ASSERT_TRUE(scan_at(0.0));
  ASSERT_TRUE(outlets.status.refresh());
  EXPECT_EQ(outlets.status.value().local_maps, 0U);
  const std::uint32_t at_home = outlets.status.value().landmarks;
  const auto first = scan_at(0.0, Place::Mirrored);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->fix.status, core::FixStatus::NoFix);
  ASSERT_TRUE(outlets.status.refresh());
  EXPECT_EQ(outlets.status.value().local_maps, 1U);
  EXPECT_GT(outlets.status.value().local_landmarks, 8U);
  EXPECT_EQ(outlets.status.value().landmarks, at_home);
  const auto second = scan_at(2.0, Place::Mirrored);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->fix.status, core::FixStatus::NoFix);
  EXPECT_EQ(second->fix.reason, core::FixReason::LocalMap);
  EXPECT_NE(second->fix.map, second->fix.home);
  EXPECT_NEAR(second->fix.pose_W.x_m, 2.0, 0.2);
}

// The posts stand twice, a quarter turn and 300 m apart: a scan of them may be at either place.
TEST_F(SlamLoopTest, AnAmbiguousScanComesWithItsRivalsAndAFixWithout) {
  const core::Pose2 copy_W{300.0, 40.0, std::numbers::pi / 2.0};
  std::vector<core::MapLandmark> landmarks;
  std::vector<core::Point2> positions_W;
  for (const auto& post : kPosts_W) {
    const core::Point2 place(post[0], post[1]);
    for (const core::Point2& p : {place, copy_W * place}) {
      landmarks.push_back({.id = static_cast<std::uint32_t>(landmarks.size())});
      positions_W.push_back(p);
    }
  }
  const core::MapState survey{.landmarks = landmarks,
                              .positions_W = positions_W,
                              .path = {},
                              .next_id = static_cast<std::uint32_t>(landmarks.size()),
                              .scans = 1,
                              .is_surveyed = true};
  ASSERT_TRUE(orders.give({.kind = MapCommand::Restore, .state = survey, .frozen = core::Frozen::Yes}));
  run();
  ASSERT_TRUE(orders.answer().value().check.ok());
  const auto message = scan_at(2.0);
  ASSERT_TRUE(message);
  ASSERT_EQ(message->fix.status, core::FixStatus::Ambiguous);
  ASSERT_EQ(message->rivals.size(), 1U);
  const core::Pose2 here{2.0, 0.0, 0.0};
  const bool is_answer_here = std::abs(message->fix.pose_W.x_m) < 10.0;
  const core::Pose2 rival_W = is_answer_here ? copy_W * here : here;
  EXPECT_NEAR(message->rivals[0].pose_W.x_m, rival_W.x_m, 0.5);
  EXPECT_NEAR(message->rivals[0].pose_W.y_m, rival_W.y_m, 0.5);
  EXPECT_NEAR(message->rivals[0].pose_W.heading_rad, rival_W.heading_rad, 0.05);
  EXPECT_GT(message->rivals[0].matches, 8U);

  ASSERT_TRUE(orders.give({MapCommand::Reset, {}}));
  run();
  static_cast<void>(orders.answer());
  ASSERT_TRUE(orders.give({MapCommand::Unfreeze, {}}));
  run();
  static_cast<void>(orders.answer());
  ASSERT_TRUE(scan_at(0.0));
  const auto fix = scan_at(2.0);
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->fix.status, core::FixStatus::Fix);
  EXPECT_TRUE(fix->rivals.empty());
}

// What a recording begins with: its replay has the map that was posted and nothing else.
TEST_F(SlamLoopTest, AfterRivalsWereDroppedItGoesOnAsOneThatHasTheMapAlone) {
  for (const double x_m : {0.0, 1.0, 2.0, 1.5, 0.5}) {
    ASSERT_TRUE(scan_at(x_m));
  }
  ASSERT_TRUE(scan_at(0.0, Place::Mirrored));
  ASSERT_TRUE(orders.give({MapCommand::DropRivals, {}}));
  run();
  const auto answer = orders.answer();
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->check.ok());
  EXPECT_EQ(revision(), answer->revision);
  ASSERT_TRUE(outlets.status.refresh());
  EXPECT_EQ(outlets.status.value().local_maps, 0U);
  Pipeline replayed(config.core);
  MapSnapshot room(config.core.capacities);
  outlets.map.read([&](const MapSnapshot& map) {
    EXPECT_TRUE(replayed.carry_out(MapCommand::Restore, map.state(), core::Frozen::No, room).ok());
  });
  for (const double x_m : {2.0, 0.0, 1.0, 3.0}) {
    const auto message = scan_at(x_m);
    ASSERT_TRUE(message);
    const core::Fix fix = replayed.process(std::vector(3, sweep_from(x_m, Place::Posts)), {}, {});
    EXPECT_NEAR(message->fix.pose_W.x_m, x_m, 0.2);
    EXPECT_EQ(fix.status, message->fix.status) << x_m;
    EXPECT_EQ(fix.pose_W.x_m, message->fix.pose_W.x_m) << x_m;
    EXPECT_EQ(fix.covariance, message->fix.covariance) << x_m;
    EXPECT_EQ(fix.scan, message->fix.scan);
    EXPECT_EQ(fix.map, message->fix.map);
    EXPECT_EQ(fix.jumps, message->fix.jumps);
  }
}

TEST_F(SlamLoopTest, AMoveOfTheCarrierAndTimingInDoubtTakeTheFixBack) {
  ASSERT_TRUE(scan_at(0.0));
  queue.push(ScanAborted{1, ScanAbort::CarrierMoved});
  run();
  FixMessage message;
  ASSERT_TRUE(outlets.fixes.pop(message));
  EXPECT_EQ(message.fix.status, core::FixStatus::NoFix);
  EXPECT_EQ(message.fix.reason, core::FixReason::Moved);
  queue.push(ScanAborted{2, ScanAbort::TimingInDoubt});
  run();
  ASSERT_TRUE(outlets.fixes.pop(message));
  EXPECT_EQ(message.fix.status, core::FixStatus::NoFix);
  EXPECT_EQ(message.fix.reason, core::FixReason::Timing);
  queue.push(ScanAborted{3, ScanAbort::PanTiltLost});
  run();
  EXPECT_FALSE(outlets.fixes.pop(message));
}

}  // namespace
}  // namespace slamsensor::firmware
