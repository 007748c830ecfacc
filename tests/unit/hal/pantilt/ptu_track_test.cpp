#include "hal/pantilt/ptu_track.hpp"

#include <gtest/gtest.h>

namespace slamsensor::hal {
namespace {

constexpr double kUnit = 0.001;  // rad a position
constexpr Stamp kHalf = std::chrono::milliseconds(2);
constexpr Stamp kSlack = std::chrono::milliseconds(3);

Stamp ms(int count) {
  return std::chrono::milliseconds(count);
}

class Track : public testing::Test {
 protected:
  Track() {
    track.set_up(kUnit, 3.0, kSlack);
    track.rest(-500);
  }

  /// 1000 positions at 1000 positions/s from 0 ms on.
  void follow() {
    track.follow({MotionProfile(-0.5, 0.5, 1.0, {1.0, 2.0}), ms(0), -500, 500, ms(0), ms(150)});
  }

  PtuVerdict see(int at_ms, int position) { return track.judge({ms(at_ms), kHalf, position}).verdict; }

  PtuTrack track;
};

TEST_F(Track, ARestingAxisReportsItsPlaceExactly) {
  EXPECT_EQ(see(0, -500), PtuVerdict::Believed);
  EXPECT_EQ(see(10, -50), PtuVerdict::Implausible);
  EXPECT_EQ(see(20, 500), PtuVerdict::Implausible);
  EXPECT_EQ(see(30, -500), PtuVerdict::Believed);
}

TEST_F(Track, ARestingAxisThatSteadilyStandsElsewhereIsLost) {
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(see(i, 0), PtuVerdict::Implausible);
  }
  EXPECT_EQ(see(5, 0), PtuVerdict::Lost);
}

TEST_F(Track, BelievesTheFirstOfAMoveWithTheSecond) {
  follow();
  EXPECT_EQ(see(25, -485), PtuVerdict::Held);
  const PtuJudgement second = track.judge({ms(50), kHalf, -460});
  EXPECT_EQ(second.verdict, PtuVerdict::Believed);
  ASSERT_TRUE(second.earlier);
  EXPECT_EQ(second.earlier->position, -485);
}

TEST_F(Track, ALostDigitIsNotBelieved) {
  follow();
  EXPECT_EQ(see(25, -485), PtuVerdict::Held);
  EXPECT_EQ(see(50, -460), PtuVerdict::Believed);
  EXPECT_EQ(see(75, -43), PtuVerdict::Implausible);
  EXPECT_EQ(see(76, 434), PtuVerdict::Implausible);
  EXPECT_EQ(see(77, -500), PtuVerdict::Implausible);
  EXPECT_EQ(see(100, -410), PtuVerdict::Believed);
}

TEST_F(Track, AReplyThatIsOnePollOldIsNotBelieved) {
  follow();
  EXPECT_EQ(see(25, -485), PtuVerdict::Held);
  EXPECT_EQ(see(50, -460), PtuVerdict::Believed);
  EXPECT_EQ(see(75, -460), PtuVerdict::Implausible);
}

TEST_F(Track, TakesUpALagThatLasts) {
  follow();
  see(25, -485);
  see(50, -460);
  EXPECT_EQ(see(200, -410), PtuVerdict::Implausible);
  EXPECT_EQ(see(225, -385), PtuVerdict::Implausible);
  EXPECT_EQ(see(250, -360), PtuVerdict::Believed);
  EXPECT_EQ(see(275, -335), PtuVerdict::Believed);
}

TEST_F(Track, AMoveThatNeverBeginsIsStuck) {
  follow();
  EXPECT_EQ(see(100, -500), PtuVerdict::Believed);
  EXPECT_EQ(see(200, -500), PtuVerdict::Implausible);
  EXPECT_EQ(see(225, -500), PtuVerdict::Implausible);
  EXPECT_EQ(see(250, -500), PtuVerdict::Stuck);
}

TEST_F(Track, ANumberOutsideTheWayIsLostInTheEnd) {
  follow();
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(see(100 + 25 * i, -700), PtuVerdict::Implausible);
  }
  EXPECT_EQ(see(200, -700), PtuVerdict::Lost);
}

TEST_F(Track, ArrivesWithTwoPollsAtTheTarget) {
  follow();
  see(25, -485);
  see(50, -460);
  EXPECT_EQ(see(1025, 500), PtuVerdict::Believed);
  EXPECT_FALSE(track.resting());
  EXPECT_EQ(see(1050, 500), PtuVerdict::Believed);
  EXPECT_TRUE(track.resting());
  EXPECT_EQ(track.position(), 500);
}

TEST_F(Track, ATargetTooEarlyIsNotBelieved) {
  follow();
  see(25, -485);
  see(50, -460);
  EXPECT_EQ(see(75, 500), PtuVerdict::Implausible);
}

TEST_F(Track, RoamsUntilThreePollsAgree) {
  track.roam();
  EXPECT_EQ(see(0, 100), PtuVerdict::Unproven);
  EXPECT_EQ(see(25, 150), PtuVerdict::Unproven);
  EXPECT_EQ(see(50, 1500), PtuVerdict::Implausible);
  EXPECT_EQ(see(75, 160), PtuVerdict::Unproven);
  EXPECT_EQ(see(100, 160), PtuVerdict::Unproven);
  EXPECT_EQ(see(125, 160), PtuVerdict::Believed);
  EXPECT_TRUE(track.resting());
}

}  // namespace
}  // namespace slamsensor::hal
