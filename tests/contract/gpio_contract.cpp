#include "tests/contract/gpio_contract.hpp"

#include "tests/support/no_alloc_scope.hpp"

#include <gmock/gmock.h>

#include <utility>

namespace slamsensor::tests {

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(GpioContract);

void GpioContract::SetUp() {
  MadeRig<GpioRig> made = GetParam().make();
  if (!made) {
    GTEST_SKIP() << "SKIPPED, the contract of GPIO lines was NOT tested on " << GetParam().name << ": "
                 << made.error();
  }
  rig_ = std::move(*made);
  rig_->drive(Wire::Low);
}

std::vector<hal::GpioEvent> GpioContract::events(hal::GpioInput& input, std::size_t count) {
  std::vector<hal::GpioEvent> got;
  for (int i = 0; i < 10'000 && got.size() < count; ++i) {
    if (const std::optional<hal::GpioEvent> event = input.next_event(rig_->now())) {
      got.push_back(*event);
    } else {
      rig_->pass(std::chrono::milliseconds(1));
    }
  }
  return got;
}

namespace {

using hal::GpioBias;
using hal::GpioEdge;
using hal::GpioEdges;
using hal::GpioEvent;
using hal::GpioInput;
using hal::GpioLevel;
using hal::GpioPolarity;
using testing::ElementsAre;

std::vector<GpioEdge> edges_of(const std::vector<GpioEvent>& events) {
  std::vector<GpioEdge> edges;
  for (const GpioEvent& event : events) {
    edges.push_back(event.edge);
  }
  return edges;
}

TEST_P(GpioContract, AnInputFollowsItsWire) {
  const auto input = rig_->input({});
  EXPECT_EQ(input->level(rig_->now()), GpioLevel::Inactive);
  rig_->drive(Wire::High);
  EXPECT_EQ(input->level(rig_->now()), GpioLevel::Active);
  rig_->drive(Wire::Low);
  EXPECT_EQ(input->level(rig_->now()), GpioLevel::Inactive);
}

TEST_P(GpioContract, AnActiveLowInputIsTurnedOver) {
  const auto input = rig_->input({.polarity = GpioPolarity::ActiveLow});
  EXPECT_EQ(input->level(rig_->now()), GpioLevel::Active);
  rig_->drive(Wire::High);
  EXPECT_EQ(input->level(rig_->now()), GpioLevel::Inactive);
  rig_->drive(Wire::Low);
  EXPECT_THAT(edges_of(events(*input, 2)), ElementsAre(GpioEdge::ToInactive, GpioEdge::ToActive));
}

TEST_P(GpioContract, EdgesComeInOrderWithTheirTimes) {
  const auto input = rig_->input({});
  EXPECT_FALSE(input->next_event(rig_->now()));
  std::vector<hal::Stamp> before;
  for (int i = 0; i < 6; ++i) {
    before.push_back(rig_->stamping_clock());
    rig_->drive(i % 2 == 0 ? Wire::High : Wire::Low);
    rig_->pass(std::chrono::milliseconds(1));
  }
  before.push_back(rig_->stamping_clock());
  const std::vector<GpioEvent> got = events(*input, 6);
  ASSERT_EQ(got.size(), 6U);
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].edge, i % 2 == 0 ? GpioEdge::ToActive : GpioEdge::ToInactive);
    EXPECT_GE(got[i].stamp, before[i]);
    EXPECT_LE(got[i].stamp, before.back());
    EXPECT_TRUE(i == 0 || got[i].stamp >= got[i - 1].stamp);
  }
  EXPECT_FALSE(input->next_event(rig_->now()));
}

TEST_P(GpioContract, OnlyTheEdgesThatWereAskedForAreReported) {
  for (const auto& [asked, expected] : {std::pair{GpioEdges::ToActive, GpioEdge::ToActive},
                                        std::pair{GpioEdges::ToInactive, GpioEdge::ToInactive}}) {
    const auto input = rig_->input({.edges = asked});
    for (int i = 0; i < 4; ++i) {
      rig_->drive(i % 2 == 0 ? Wire::High : Wire::Low);
      rig_->pass(std::chrono::milliseconds(1));
    }
    EXPECT_THAT(edges_of(events(*input, 2)), ElementsAre(expected, expected));
    EXPECT_FALSE(input->next_event(rig_->now()));
  }
}

TEST_P(GpioContract, WithoutEdgesThereAreLevelsOnly) {
  const auto input = rig_->input({.edges = GpioEdges::None});
  EXPECT_EQ(input->fd(), -1);
  rig_->drive(Wire::High);
  EXPECT_FALSE(input->next_event(rig_->now()));
  EXPECT_EQ(input->level(rig_->now()), GpioLevel::Active);
}

TEST_P(GpioContract, TheBiasPullsAWireThatNobodyDrives) {
  EXPECT_EQ(rig_->input({.bias = GpioBias::PullUp})->level(rig_->now()), GpioLevel::Active);
  EXPECT_EQ(rig_->input({.bias = GpioBias::PullDown})->level(rig_->now()), GpioLevel::Inactive);
}

TEST_P(GpioContract, ADebouncedInputSettles) {
  const auto input = rig_->input({.debounce = std::chrono::milliseconds(30)});
  for (int bounce = 0; bounce < 3; ++bounce) {
    rig_->drive(Wire::High);
    rig_->drive(Wire::Low);
  }
  rig_->drive(Wire::High);
  const std::vector<GpioEvent> up = events(*input, 1);
  // On a machine that is stopped for long between two bounces, some of them are changes for good.
  ASSERT_GE(up.size(), 1U);
  EXPECT_EQ(up.front().edge, GpioEdge::ToActive);
  EXPECT_LE(up.front().stamp, rig_->stamping_clock());
  rig_->pass(std::chrono::milliseconds(100));
  std::vector<GpioEvent> all = up;
  while (const std::optional<GpioEvent> event = input->next_event(rig_->now())) {
    EXPECT_NE(event->edge, all.back().edge);
    all.push_back(*event);
  }
  EXPECT_LE(all.size(), 7U);
  rig_->drive(Wire::Low);
  const std::vector<GpioEvent> down = events(*input, 1);
  EXPECT_THAT(edges_of(down), ElementsAre(GpioEdge::ToInactive));
  EXPECT_EQ(input->level(rig_->now()), GpioLevel::Inactive);
}

TEST_P(GpioContract, AnOutputDrivesItsWire) {
  const auto output = rig_->output(GpioPolarity::ActiveHigh, GpioLevel::Inactive);
  EXPECT_EQ(rig_->seen(), Wire::Low);
  EXPECT_EQ(output->set(GpioLevel::Active), hal::GpioStatus::Ok);
  EXPECT_EQ(rig_->seen(), Wire::High);
  EXPECT_EQ(output->level(), GpioLevel::Active);
  EXPECT_EQ(output->set(GpioLevel::Inactive), hal::GpioStatus::Ok);
  EXPECT_EQ(rig_->seen(), Wire::Low);
  EXPECT_EQ(output->level(), GpioLevel::Inactive);
}

TEST_P(GpioContract, AnOutputStartsWhereItIsSetAndTurnsOverWhenActiveLow) {
  {
    const auto output = rig_->output(GpioPolarity::ActiveHigh, GpioLevel::Active);
    EXPECT_EQ(rig_->seen(), Wire::High);
    EXPECT_EQ(output->level(), GpioLevel::Active);
  }
  const auto output = rig_->output(GpioPolarity::ActiveLow, GpioLevel::Active);
  EXPECT_EQ(rig_->seen(), Wire::Low);
  EXPECT_EQ(output->set(GpioLevel::Inactive), hal::GpioStatus::Ok);
  EXPECT_EQ(rig_->seen(), Wire::High);
}

TEST_P(GpioContract, NeverAsksTheHeap) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizer's heap cannot be watched";
  }
  const auto output = rig_->output(GpioPolarity::ActiveHigh, GpioLevel::Inactive);
  std::uint64_t calls = 0;
  for (const hal::Stamp debounce : {hal::Stamp{}, hal::Stamp(std::chrono::milliseconds(2))}) {
    const auto input = rig_->input({.debounce = debounce});
    for (int i = 0; i < 20; ++i) {
      rig_->drive(i % 2 == 0 ? Wire::High : Wire::Low);
      rig_->pass(std::chrono::milliseconds(3));
      const NoAllocScope scope;
      static_cast<void>(input->level(rig_->now()));
      static_cast<void>(input->next_event(rig_->now()));
      static_cast<void>(output->set(i % 2 == 0 ? GpioLevel::Active : GpioLevel::Inactive));
      calls += scope.heap_calls();
    }
  }
  if (rig_->promises_no_heap()) {
    EXPECT_EQ(calls, 0U);
  }
}

}  // namespace
}  // namespace slamsensor::tests
