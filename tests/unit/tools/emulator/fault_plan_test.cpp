#include "tools/emulator/fault.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;

std::vector<DueFault> all_until(FaultPlan& plan, hal::Stamp end) {
  std::vector<DueFault> all;
  while (auto due = plan.take(end)) {
    all.push_back(*due);
  }
  return all;
}

TEST(FaultPlan, GivenTimesComeInOrderWhateverTheirOrderInTheList) {
  const std::vector<PlannedFault> planned = {{"ptu", FaultKind::PowerCycle, 5.0, 2.0},
                                             {"rangefinder", FaultKind::Noise, 1.5, 0.1},
                                             {"ptu", FaultKind::LateReply, 5.0, 0.5}};
  FaultPlan plan(planned, {}, 1);
  EXPECT_EQ(plan.next(), 1500ms);
  EXPECT_FALSE(plan.take(1499ms).has_value());
  const auto first = plan.take(1500ms);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->device, "rangefinder");
  EXPECT_EQ(first->fault.duration, 100ms);
  const auto rest = all_until(plan, 10s);
  ASSERT_EQ(rest.size(), 2U);
  EXPECT_EQ(rest[0].fault.kind, FaultKind::PowerCycle);
  EXPECT_EQ(rest[1].fault.kind, FaultKind::LateReply);
  EXPECT_EQ(plan.next(), hal::kNever);
}

TEST(FaultPlan, ARegularRateKeepsItsBeat) {
  FaultRate rate{"ptu", FaultKind::DropByte, FaultRhythm::Regular, 10.0, 5.0, 40.0, 0.0};
  FaultPlan plan({}, std::vector{rate}, 1);
  const auto all = all_until(plan, 1000s);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].fault.at, 15s);
  EXPECT_EQ(all[2].fault.at, 35s);
}

TEST(FaultPlan, APoissonRateHasItsMeanAndItsSpread) {
  constexpr std::uint64_t kSeed = 11;
  FaultRate rate{"ptu", FaultKind::DropByte, FaultRhythm::Chance, 2.0, 0.0, 1e9, 0.0};
  FaultPlan plan({}, std::vector{rate}, kSeed);
  const auto all = all_until(plan, 20'000s);
  EXPECT_NEAR(static_cast<double>(all.size()), 10'000.0, 400.0) << "seed " << kSeed;
  std::size_t short_gaps = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    short_gaps += all[i].fault.at - all[i - 1].fault.at < 2s ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(short_gaps) / static_cast<double>(all.size()), 1.0 - std::exp(-1.0), 0.02);
}

TEST(FaultPlan, EqualSeedsGiveEqualFaultsAndOtherSeedsOthers) {
  const auto run = [](std::uint64_t seed) {
    const std::vector<FaultRate> rates = {{"ptu", FaultKind::DropByte, FaultRhythm::Chance, 3.0},
                                          {"rangefinder", FaultKind::Noise, FaultRhythm::Chance, 7.0}};
    FaultPlan plan({}, rates, seed);
    std::vector<hal::Stamp> times;
    for (const DueFault& due : all_until(plan, 200s)) {
      times.push_back(due.fault.at);
    }
    EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
    return times;
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

}  // namespace
}  // namespace slamsensor::tools
