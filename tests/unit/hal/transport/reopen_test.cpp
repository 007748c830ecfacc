#include "hal/transport/reopen.hpp"

#include <gtest/gtest.h>

namespace slamsensor::hal {
namespace {

constexpr Stamp ms(int count) {
  return std::chrono::milliseconds(count);
}

/// When the next attempt is due, looking every millisecond from `from`.
Stamp next_due(const ReopenTimer& timer, Stamp from) {
  while (!timer.is_due(from)) {
    from += ms(1);
  }
  return from;
}

TEST(ReopenTimer, IsDueAtOnceTheFirstTimeWhateverTheTime) {
  EXPECT_TRUE(ReopenTimer({}).is_due(Stamp{}));
  EXPECT_TRUE(ReopenTimer({}).is_due(-ms(1)));
}

TEST(ReopenTimer, DoublesTheWaitUpToTheLongest) {
  ReopenTimer timer({ms(50), ms(2000)});
  Stamp now{};
  for (const int wait : {50, 100, 200, 400, 800, 1600, 2000, 2000, 2000}) {
    timer.failed(now);
    EXPECT_FALSE(timer.is_due(now + ms(wait) - Stamp(1)));
    EXPECT_EQ(next_due(timer, now), now + ms(wait));
    now += ms(wait);
  }
}

TEST(ReopenTimer, StartsOverAfterALinkThatStood) {
  ReopenTimer timer({ms(50), ms(2000)});
  for (int i = 0; i < 8; ++i) {
    timer.failed(ms(0));
  }
  timer.opened(ms(5000));
  timer.lost(ms(7000));
  EXPECT_EQ(next_due(timer, ms(7000)), ms(7050));
}

TEST(ReopenTimer, KeepsBackingOffFromALinkThatIsLostAtOnce) {
  ReopenTimer timer({ms(50), ms(2000)});
  Stamp now{};
  for (const int wait : {50, 100, 200, 400, 800, 1600, 2000, 2000}) {
    timer.opened(now);
    timer.lost(now + ms(1));
    EXPECT_EQ(next_due(timer, now + ms(1)), now + ms(1 + wait));
    now += ms(1 + wait);
  }
}

TEST(ReopenTimer, TakesEqualWaits) {
  ReopenTimer timer({ms(1), ms(1)});
  for (int i = 0; i < 5; ++i) {
    timer.failed(ms(i));
    EXPECT_EQ(next_due(timer, ms(i)), ms(i + 1));
  }
}

TEST(ReopenConfig, IsBounded) {
  EXPECT_TRUE(is_valid({}));
  EXPECT_TRUE(is_valid({ms(1), ms(60'000)}));
  EXPECT_FALSE(is_valid({ms(0), ms(10)}));
  EXPECT_FALSE(is_valid({ms(20), ms(10)}));
  EXPECT_FALSE(is_valid({ms(1), ms(60'001)}));
}

}  // namespace
}  // namespace slamsensor::hal
