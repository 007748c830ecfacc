// The promise of DESIGN 2.7 and 7: after construction the method takes no memory, no page fault, and little
// stack.
#include "tests/rt/rehearsal.hpp"
#include "tests/rt/walks.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace slamsensor::tests {
namespace {

constexpr std::size_t kStackMax_bytes = 256 * 1024;

class SlamInRealTime : public testing::TestWithParam<NamedWalk> {};

/// The cost of a walk with a new Slam, whose block was written once, by its construction.
Cost cost_of_walk(const Walk& walk) {
  const auto slam = std::make_unique<InArena<core::Slam>>(walk.config);
  std::vector<core::Fix> fixes(walk.scans.size());
  if (!hold_memory()) {
    ADD_FAILURE() << "memory was held before and cannot be held now";
  }
  const Cost cost = cost_of([&] { run(walk, **slam, fixes); });
  walk.expect_events(walk, **slam, fixes);
  return cost;
}

TEST_P(SlamInRealTime, TakesNoMemoryAndLittleStack) {
  const Cost cost = cost_of_walk(GetParam().make());
  if (!NoAllocScope::works()) {
    GTEST_SKIP()
        << "SKIPPED: the walk was made, but a sanitizer's heap and stack are not those of the product";
  }
  EXPECT_EQ(cost.heap_calls, 0U);
  EXPECT_LT(cost.stack_bytes, kStackMax_bytes);
  RecordProperty("stack_bytes", std::to_string(cost.stack_bytes));
}

// The kernel may take a page away for its own reasons (migration, compaction), so a walk has three tries; a
// page that the method has not touched before faults in every one of them, as each has a block of its own.
TEST_P(SlamInRealTime, TakesNoPageFault) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: a sanitizer's shadow memory faults as it likes";
  }
  if (!hold_memory()) {
    GTEST_SKIP() << "SKIPPED: memory can neither be locked (ulimit -l) nor populated (Linux 5.14) here";
  }
  std::uint64_t fewest = UINT64_MAX;
  for (int attempt = 0; attempt < 3 && fewest > 0; ++attempt) {
    fewest = std::min(fewest, cost_of_walk(GetParam().make()).page_faults);
  }
  EXPECT_EQ(fewest, 0U);
}

INSTANTIATE_TEST_SUITE_P(Walks, SlamInRealTime, testing::ValuesIn(all_walks()),
                         [](const auto& walk) { return std::string(walk.param.name); });

}  // namespace
}  // namespace slamsensor::tests
