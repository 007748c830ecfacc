#include "firmware/daemon/realtime.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace slamsensor::firmware {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(PeriodicTimer, KeepsTheGridOfItsFirstStep) {
  PeriodicTimer timer(milliseconds(1), milliseconds(5));
  timer.begin_step(milliseconds(10));
  EXPECT_EQ(timer.due(), milliseconds(10));
  timer.end_step(milliseconds(10) + microseconds(300));
  timer.begin_step(milliseconds(11) + microseconds(80));
  EXPECT_EQ(timer.due(), milliseconds(11));
  timer.end_step(milliseconds(11) + microseconds(200));
  EXPECT_EQ(timer.wake_latency_max(), microseconds(80));
  EXPECT_EQ(timer.step_max(), microseconds(300));
  EXPECT_EQ(timer.count(TimerEvent::Wakes), 2U);
  EXPECT_EQ(timer.count(TimerEvent::PeriodsSkipped), 0U);
  EXPECT_EQ(timer.count(TimerEvent::DeadlineMisses), 0U);
}

TEST(PeriodicTimer, SlipsAreCountedAndNotMadeUpFor) {
  PeriodicTimer timer(milliseconds(1), milliseconds(5));
  timer.begin_step(milliseconds(10));
  timer.end_step(milliseconds(13) + microseconds(500));  // over 11, 12 and 13
  EXPECT_EQ(timer.count(TimerEvent::PeriodsSkipped), 3U);
  EXPECT_EQ(timer.count(TimerEvent::DeadlineMisses), 0U);
  timer.begin_step(milliseconds(14));
  EXPECT_EQ(timer.due(), milliseconds(14));
  EXPECT_EQ(timer.wake_latency_max(), milliseconds(0));
}

TEST(PeriodicTimer, AStepThatEndsWithItsPeriodIsInTime) {
  PeriodicTimer timer(milliseconds(1), milliseconds(1));
  timer.begin_step(milliseconds(10));
  timer.end_step(milliseconds(11));
  EXPECT_EQ(timer.count(TimerEvent::PeriodsSkipped), 0U);
  EXPECT_EQ(timer.count(TimerEvent::DeadlineMisses), 0U);
}

TEST(PeriodicTimer, MissesAreFromWhenTheStepWasDue) {
  PeriodicTimer timer(milliseconds(10), milliseconds(5));
  timer.begin_step(milliseconds(100));
  timer.end_step(milliseconds(101));
  timer.begin_step(milliseconds(114));  // 4 ms late
  timer.end_step(milliseconds(115) + microseconds(1));
  EXPECT_EQ(timer.count(TimerEvent::DeadlineMisses), 1U);
  EXPECT_EQ(timer.wake_latency_max(), milliseconds(4));
}

TEST(PeriodicTimer, SleepsUntilTheNextStepIsDue) {
  PeriodicTimer timer(milliseconds(2), milliseconds(1000));
  const hal::Stamp first = timer.wait();
  timer.end_step(first);
  EXPECT_GE(timer.wait(), first + milliseconds(2));
}

}  // namespace
}  // namespace slamsensor::firmware
