#include "firmware/output/nmea_publisher.hpp"

#include <gmock/gmock.h>

#include <random>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using testing::ElementsAre;

constexpr nanoseconds kNoon = std::chrono::sys_days(std::chrono::year(2026) / 3 / 1).time_since_epoch() + 12h;
constexpr hal::Stamp kUptime = 5000s;

/// The moment `since` after noon, on both clocks.
OutputTime at(nanoseconds since) {
  return {kUptime + since, kNoon + since};
}

/// Stamps, as times since noon, of the epochs of a span that is looked at every millisecond.
std::vector<std::chrono::milliseconds> stamps(EpochPlanner& planner, nanoseconds from, nanoseconds to) {
  std::vector<std::chrono::milliseconds> result;
  for (nanoseconds t = from; t < to; t += 1ms) {
    if (const auto epoch = planner.next(at(t), EpochNews::None)) {
      EXPECT_EQ(epoch->kind, EpochKind::Regular);
      EXPECT_EQ(epoch->missed, 0U);
      result.push_back(std::chrono::duration_cast<std::chrono::milliseconds>(epoch->utc - kNoon));
    }
  }
  return result;
}

TEST(EpochPlanner, EpochsStandAtTheWholeMultiplesOfThePeriod) {
  EpochPlanner once(1.0);
  EXPECT_THAT(stamps(once, 300ms, 3500ms), ElementsAre(1s, 2s, 3s));
  EpochPlanner five(5.0);
  EXPECT_THAT(stamps(five, 1ms, 1001ms), ElementsAre(200ms, 400ms, 600ms, 800ms, 1000ms));
  EpochPlanner slow(0.1);
  EXPECT_THAT(stamps(slow, 5s, 25s), ElementsAre(10s, 20s));
  EpochPlanner ten(10.0);
  EXPECT_EQ(stamps(ten, 1ms, 60s).size(), 599U);
}

// A rate whose period is no whole number of milliseconds stays on the whole seconds all day long.
TEST(EpochPlanner, ARateOfThreeHertzHasAnEpochAtEveryWholeSecond) {
  EpochPlanner planner(3.0);
  EXPECT_THAT(stamps(planner, 900ms, 2100ms), ElementsAre(1000ms, 1330ms, 1660ms, 2000ms));
  EpochPlanner later(3.0);
  EXPECT_THAT(stamps(later, 23h + 900ms, 23h + 1100ms), ElementsAre(23h + 1s));
}

TEST(EpochPlanner, AStampIsThatOfTheGridHoweverLateTheCallComes) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next(at(500ms), EpochNews::None));
  EXPECT_EQ(planner.next(at(1s + 37ms), EpochNews::None)->utc, kNoon + 1s);
  EXPECT_FALSE(planner.next(at(1s + 38ms), EpochNews::None));
}

TEST(EpochPlanner, OfMissedEpochsOnlyTheLastIsGivenAndTheOthersAreCounted) {
  EpochPlanner planner(10.0);
  EXPECT_FALSE(planner.next(at(0ms), EpochNews::None));
  const auto epoch = planner.next(at(455ms), EpochNews::None);
  EXPECT_EQ(epoch->utc, kNoon + 400ms);
  EXPECT_EQ(epoch->missed, 3U);
}

TEST(EpochPlanner, NewsComeAtOnceAndTheGridGoesOn) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next(at(100ms), EpochNews::None));
  const auto prompt = planner.next(at(437ms), EpochNews::Waiting);
  ASSERT_TRUE(prompt);
  EXPECT_EQ(prompt->kind, EpochKind::Prompt);
  EXPECT_EQ(prompt->utc, kNoon + 430ms);
  EXPECT_FALSE(planner.next(at(438ms), EpochNews::None));
  EXPECT_EQ(planner.next(at(1s), EpochNews::None)->utc, kNoon + 1s);
}

TEST(EpochPlanner, ARegularEpochTakesTheNewsAlong) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next(at(0ms), EpochNews::None));
  EXPECT_EQ(planner.next(at(1s), EpochNews::Waiting)->kind, EpochKind::Regular);
}

// gpsd takes stamps 10 ms apart for one epoch: its ATT then had the time of a GST before it, with two commas.
TEST(EpochPlanner, NewsRightAfterARegularEpochAreStampedTwoHundredthsLater) {
  EpochPlanner planner(10.0);
  EXPECT_FALSE(planner.next(at(50ms), EpochNews::None));
  EXPECT_EQ(planner.next(at(100ms), EpochNews::None)->utc, kNoon + 100ms);
  EXPECT_EQ(planner.next(at(101ms), EpochNews::Waiting)->utc, kNoon + 120ms);
  EXPECT_EQ(planner.next(at(200ms), EpochNews::None)->utc, kNoon + 200ms);
}

TEST(EpochPlanner, NewsRightBeforeARegularEpochGoWithIt) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next(at(0ms), EpochNews::None));
  EXPECT_FALSE(planner.next(at(992ms), EpochNews::Waiting));
  const auto epoch = planner.next(at(1s), EpochNews::Waiting);
  EXPECT_EQ(epoch->kind, EpochKind::Regular);
  EXPECT_EQ(epoch->utc, kNoon + 1s);
  EXPECT_EQ(planner.next(at(1985ms), EpochNews::Waiting)->utc, kNoon + 1980ms);
}

TEST(EpochPlanner, StampsAreTwoHundredthsApartWhateverComes) {
  EpochPlanner planner(10.0);
  std::optional<nanoseconds> last;
  for (int ms = 0; ms < 20'000; ++ms) {
    const bool has_news = ms % 7 == 0 || ms % 101 < 3;
    const auto epoch =
        planner.next(at(std::chrono::milliseconds(ms)), has_news ? EpochNews::Waiting : EpochNews::None);
    if (epoch) {
      EXPECT_TRUE(!last || epoch->utc - *last >= 20ms) << ms;
      last = epoch->utc;
    }
  }
}

TEST(EpochPlanner, NewsUponNewsWaitForTheGapOrTheGrid) {
  EpochPlanner planner(0.1);
  EXPECT_FALSE(planner.next(at(100ms), EpochNews::None));
  EXPECT_TRUE(planner.next(at(200ms), EpochNews::Waiting));
  EXPECT_FALSE(planner.next(at(1199ms), EpochNews::Waiting));
  EXPECT_EQ(planner.wait(at(1150ms), EpochNews::Waiting), 50ms);
  EXPECT_EQ(planner.next(at(1200ms), EpochNews::Waiting)->kind, EpochKind::Prompt);
}

TEST(EpochPlanner, TheFirstRegularEpochOfASecondIsMarked) {
  EpochPlanner planner(5.0);
  int marked = 0;
  for (nanoseconds t = 0ms; t < 10s; t += 10ms) {
    const auto epoch = planner.next(at(t), t == 2570ms ? EpochNews::Waiting : EpochNews::None);
    if (epoch && epoch->begins_second) {
      ++marked;
      EXPECT_TRUE(marked == 1 || epoch->utc % 1s == 0s);
    }
  }
  EXPECT_EQ(marked, 10);
}

TEST(EpochPlanner, AClockThatIsSetBackIsFollowed) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next(at(500ms), EpochNews::None));
  EXPECT_TRUE(planner.next(at(1s), EpochNews::None));
  const auto later = [](nanoseconds since) { return OutputTime{kUptime + since, kNoon - 24h + since}; };
  EXPECT_FALSE(planner.next(later(1100ms), EpochNews::None));
  EXPECT_EQ(planner.clock_steps(), 1U);
  EXPECT_EQ(planner.next(later(2s), EpochNews::None)->utc, kNoon - 24h + 2s);
}

TEST(EpochPlanner, AClockThatIsSetForwardMissesNothing) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next({kUptime, 0s}, EpochNews::None));
  EXPECT_FALSE(planner.next({kUptime + 100ms, kNoon + 100ms}, EpochNews::None));
  const auto epoch = planner.next({kUptime + 1s, kNoon + 1s}, EpochNews::None);
  EXPECT_EQ(epoch->utc, kNoon + 1s);
  EXPECT_EQ(epoch->missed, 0U);
  EXPECT_EQ(planner.clock_steps(), 1U);
}

TEST(EpochPlanner, AClockThatIsSlewedBackNeverRepeatsAStamp) {
  EpochPlanner planner(10.0);
  EXPECT_FALSE(planner.next(at(0ms), EpochNews::None));
  EXPECT_TRUE(planner.next(at(200ms), EpochNews::None));
  const auto slewed = [](nanoseconds since) { return OutputTime{kUptime + since, kNoon + since - 150ms}; };
  EXPECT_FALSE(planner.next(slewed(210ms), EpochNews::None));
  EXPECT_FALSE(planner.next(slewed(360ms), EpochNews::None));
  EXPECT_EQ(planner.next(slewed(450ms), EpochNews::None)->utc, kNoon + 300ms);
  EXPECT_EQ(planner.clock_steps(), 0U);
}

TEST(EpochPlanner, AnotherRateBeginsAtItsNextMultiple) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next(at(0ms), EpochNews::None));
  EXPECT_TRUE(planner.next(at(1s), EpochNews::None));
  planner.set_rate(10.0);
  EXPECT_FALSE(planner.next(at(1050ms), EpochNews::None));
  EXPECT_EQ(planner.next(at(1100ms), EpochNews::None)->utc, kNoon + 1100ms);
}

TEST(EpochPlanner, TimesBefore1970KeepTheirOrder) {
  EpochPlanner planner(1.0);
  EXPECT_FALSE(planner.next({kUptime, -2s - 500ms}, EpochNews::None));
  EXPECT_EQ(planner.next({kUptime + 600ms, -1900ms}, EpochNews::None)->utc, -2s);
  EXPECT_EQ(planner.next({kUptime + 2500ms, 0s}, EpochNews::None)->utc, 0s);
}

// Whatever the rate and whenever news and calls come: stamps are whole hundredths that rise, regular ones
// stand on the grid, none is ahead of the time by more than a hundredth, and waiting as told misses none.
TEST(EpochPlannerProperty, StampsRiseAndTheGridIsKept) {
  constexpr unsigned kSeed = 20260301;
  std::mt19937_64 random(kSeed);
  for (int run = 0; run < 200; ++run) {
    const auto rate_mhz = std::uniform_int_distribution<std::int64_t>(100, 10'000)(random);
    EpochPlanner planner(static_cast<double>(rate_mhz) / 1000.0);
    nanoseconds t{std::uniform_int_distribution<std::int64_t>(0, 1'000'000'000)(random)};
    nanoseconds last = nanoseconds::min();
    std::int64_t regular = 0;
    EpochNews news = EpochNews::None;
    const nanoseconds begin = t;
    for (int i = 0; i < 500; ++i) {
      news = std::uniform_int_distribution(0, 9)(random) == 0 ? EpochNews::Waiting : news;
      if (const auto epoch = planner.next(at(t), news)) {
        ASSERT_GT(epoch->utc, last) << "seed " << kSeed << " run " << run;
        ASSERT_EQ(epoch->utc % 10ms, 0ns);
        ASSERT_LE(epoch->utc, kNoon + t + 20ms);
        ASSERT_EQ(epoch->missed, 0U) << "seed " << kSeed << " run " << run;
        regular += epoch->kind == EpochKind::Regular ? 1 : 0;
        last = epoch->utc;
        news = EpochNews::None;
      }
      const hal::Stamp wait = planner.wait(at(t), news);
      ASSERT_GT(wait, 0ns);
      t += std::min<nanoseconds>(
          wait, nanoseconds(std::uniform_int_distribution<std::int64_t>(1, 300'000'000)(random)));
    }
    const double expected = static_cast<double>((t - begin).count()) * 1e-12 * static_cast<double>(rate_mhz);
    ASSERT_NEAR(static_cast<double>(regular), expected, 1.001) << "seed " << kSeed << " run " << run;
  }
}

}  // namespace
}  // namespace slamsensor::firmware
