#include "hal/gpio/gpio.hpp"

#include <gtest/gtest.h>

namespace slamsensor::hal {
namespace {

constexpr Stamp ms(int count) {
  return std::chrono::milliseconds(count);
}

void expect_event(const std::optional<GpioEvent>& event, GpioEdge edge, Stamp stamp) {
  ASSERT_TRUE(event);
  EXPECT_EQ(event->edge, edge);
  EXPECT_EQ(event->stamp, stamp);
}

TEST(Debouncer, PassesAChangeThatLastsStampedWithItsBeginning) {
  Debouncer debouncer(ms(10), GpioLevel::Inactive);
  EXPECT_FALSE(debouncer.take({GpioEdge::ToActive, ms(100)}));
  EXPECT_FALSE(debouncer.settle(ms(109)));
  EXPECT_EQ(debouncer.settled(), GpioLevel::Inactive);
  expect_event(debouncer.settle(ms(110)), GpioEdge::ToActive, ms(100));
  EXPECT_EQ(debouncer.settled(), GpioLevel::Active);
  EXPECT_FALSE(debouncer.settle(ms(500)));
}

TEST(Debouncer, SwallowsAGlitch) {
  Debouncer debouncer(ms(10), GpioLevel::Inactive);
  EXPECT_FALSE(debouncer.take({GpioEdge::ToActive, ms(100)}));
  EXPECT_FALSE(debouncer.take({GpioEdge::ToInactive, ms(105)}));
  EXPECT_FALSE(debouncer.settle(ms(1000)));
}

TEST(Debouncer, WaitsForTheLastBounce) {
  Debouncer debouncer(ms(10), GpioLevel::Inactive);
  for (int t = 100; t < 140; t += 4) {
    EXPECT_FALSE(debouncer.take({t % 8 == 4 ? GpioEdge::ToActive : GpioEdge::ToInactive, ms(t)}));
  }
  EXPECT_FALSE(debouncer.take({GpioEdge::ToActive, ms(140)}));
  expect_event(debouncer.settle(ms(150)), GpioEdge::ToActive, ms(140));
}

TEST(Debouncer, HandsOutWhatHadSettledBeforeTheNextEdge) {
  Debouncer debouncer(ms(10), GpioLevel::Active);
  EXPECT_FALSE(debouncer.take({GpioEdge::ToInactive, ms(0)}));
  expect_event(debouncer.take({GpioEdge::ToActive, ms(100)}), GpioEdge::ToInactive, ms(0));
  expect_event(debouncer.settle(ms(200)), GpioEdge::ToActive, ms(100));
}

TEST(Debouncer, TheSameLevelTwiceStartsItsWaitAgain) {
  Debouncer debouncer(ms(10), GpioLevel::Inactive);
  EXPECT_FALSE(debouncer.take({GpioEdge::ToActive, ms(100)}));
  EXPECT_FALSE(debouncer.take({GpioEdge::ToActive, ms(105)}));  // the edge between was lost
  EXPECT_FALSE(debouncer.settle(ms(110)));
  expect_event(debouncer.settle(ms(115)), GpioEdge::ToActive, ms(105));
}

TEST(Debouncer, WithoutAPeriodPassesEverything) {
  Debouncer debouncer(Stamp{}, GpioLevel::Inactive);
  EXPECT_FALSE(debouncer.take({GpioEdge::ToActive, ms(1)}));
  expect_event(debouncer.settle(ms(1)), GpioEdge::ToActive, ms(1));
}

}  // namespace
}  // namespace slamsensor::hal
