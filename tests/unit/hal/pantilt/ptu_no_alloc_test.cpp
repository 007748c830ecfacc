#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/hal/pantilt/ptu_bench.hpp"

#include <gtest/gtest.h>

namespace slamsensor::tests {
namespace {

TEST(PtuDriver, AsksTheHeapForNothingAfterItsConstruction) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "the heap cannot be watched under a sanitizer";
  }
  PtuBench bench;
  std::uint64_t heap_calls = 0;
  for (int i = 0; i < 20'000; ++i) {
    bench.now += std::chrono::milliseconds(1);
    bench.link.set_now(bench.now);
    {
      const NoAllocScope scope;
      bench.driver->step(bench.now);
      if (i % 4000 == 3999) {
        static_cast<void>(bench.driver->move(hal::Axis::Pan, bench.rad(i % 3), bench.rad(1000)));
      }
      heap_calls += scope.heap_calls();
    }
    if (i == 10'000) {
      bench.unit.say("\xff* 12!P\r\n", bench.now);
    }
    for (const ScriptedLink::Written& written : bench.link.take_writes()) {
      bench.unit.on_write(written);
    }
  }
  EXPECT_EQ(bench.driver->state(), hal::DeviceState::Ready);
  EXPECT_GE(bench.counter("resyncs"), 1U);
  EXPECT_EQ(heap_calls, 0U);
}

}  // namespace
}  // namespace slamsensor::tests
