#include "firmware/supervision/service.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;

TEST(Heartbeats, SilenceCountsFromTheFirstLook) {
  Heartbeats heartbeats;
  static_cast<void>(heartbeats.add({"scan", 1s}));
  EXPECT_FALSE(heartbeats.check(5000s));
  EXPECT_FALSE(heartbeats.check(5001s));
  const auto stalled = heartbeats.check(5001s + 1ns);
  ASSERT_TRUE(stalled);
  EXPECT_EQ(stalled->name, "scan");
  EXPECT_EQ(stalled->silence, 1s + 1ns);
}

TEST(Heartbeats, NamesWhoIsFarthestBeyondItsTime) {
  Heartbeats heartbeats;
  static_cast<void>(heartbeats.add({"quick", 1s}));
  static_cast<void>(heartbeats.add({"slow", 60s}));
  EXPECT_FALSE(heartbeats.check(0s));
  EXPECT_EQ(heartbeats.check(61s)->name, "quick");
}

TEST(Heartbeats, HasRoomForSoManyAndIgnoresOthers) {
  Heartbeats heartbeats;
  for (std::size_t i = 0; i < Heartbeats::kThreadsMax; ++i) {
    EXPECT_EQ(heartbeats.add({"thread", 1s}), i);
  }
  EXPECT_FALSE(heartbeats.add({"one too many", 1s}));
  heartbeats.beat(Heartbeats::kThreadsMax);
  EXPECT_FALSE(heartbeats.check(0s));
}

TEST(Heartbeats, BeatsOfOtherThreadsAreSeen) {
  Heartbeats heartbeats;
  const std::size_t scan = heartbeats.add({"scan", 1s}).value();
  for (hal::Stamp now = 0s; now < 10s; now += 1s) {
    EXPECT_FALSE(heartbeats.check(now));
    std::thread([&] { heartbeats.beat(scan); }).join();
  }
}

}  // namespace
}  // namespace slamsensor::firmware
