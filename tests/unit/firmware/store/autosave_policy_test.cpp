#include "firmware/store/map_store.hpp"

#include <gtest/gtest.h>

namespace slamsensor::firmware {
namespace {

using std::chrono::seconds;

TEST(AutosavePolicy, SavesAChangedMapOncePerPeriod) {
  AutosavePolicy policy(seconds(60), seconds(1000));
  EXPECT_FALSE(policy.is_due(5, seconds(1059)));
  EXPECT_TRUE(policy.is_due(5, seconds(1060)));
  policy.saved(5, seconds(1061));
  EXPECT_FALSE(policy.is_due(5, seconds(5000))) << "nothing has changed";
  EXPECT_FALSE(policy.is_due(6, seconds(1120)));
  EXPECT_TRUE(policy.is_due(6, seconds(1121)));
}

TEST(AutosavePolicy, AMapThatWasLoadedIsSaved) {
  AutosavePolicy policy(seconds(60), seconds(0));
  EXPECT_TRUE(policy.is_unsaved(1));
  policy.saved(1, seconds(0));
  EXPECT_FALSE(policy.is_unsaved(1));
  EXPECT_TRUE(policy.is_unsaved(2));
}

TEST(AutosavePolicy, WithoutAPeriodNothingIsDueButUnsavedIsReported) {
  AutosavePolicy policy(seconds(0), seconds(0));
  EXPECT_FALSE(policy.is_due(7, seconds(100'000)));
  EXPECT_TRUE(policy.is_unsaved(7));
}

TEST(AutosavePolicy, FailuresAreTriedAgainEverMoreSeldom) {
  AutosavePolicy policy(seconds(60), seconds(0));
  hal::Stamp now = seconds(60);
  for (const int wait : {60, 120, 240, 480, 900, 900}) {
    ASSERT_TRUE(policy.is_due(1, now));
    policy.failed(now);
    EXPECT_FALSE(policy.is_due(1, now + seconds(wait) - hal::Stamp(1))) << wait;
    now += seconds(wait);
  }
  policy.saved(1, now);
  EXPECT_TRUE(policy.is_due(2, now + seconds(60))) << "a success ends it";
  policy.failed(now + seconds(60));
  EXPECT_TRUE(policy.is_due(2, now + seconds(120)));
}

TEST(AutosavePolicy, ShortAndLongPeriodsBoundTheBackOff) {
  AutosavePolicy quick(hal::from_seconds(0.1), seconds(0));
  quick.failed(seconds(0));
  EXPECT_FALSE(quick.is_due(1, hal::from_seconds(0.9)));
  EXPECT_TRUE(quick.is_due(1, seconds(1)));
  AutosavePolicy slow(seconds(3600), seconds(0));
  slow.failed(seconds(0));
  slow.failed(seconds(3600));
  EXPECT_TRUE(slow.is_due(1, seconds(7200)));
}

TEST(AutosavePolicy, ANewPeriodCountsFromTheLastSave) {
  AutosavePolicy policy(seconds(600), seconds(0));
  policy.saved(1, seconds(100));
  policy.set_period(seconds(60));
  EXPECT_FALSE(policy.is_due(2, seconds(159)));
  EXPECT_TRUE(policy.is_due(2, seconds(160)));
  policy.set_period(seconds(0));
  EXPECT_FALSE(policy.is_due(2, seconds(1000)));
}

}  // namespace
}  // namespace slamsensor::firmware
