// The guards see what they are there to see: each is shown a planted offence.
#include "tests/rt/rehearsal.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <sys/mman.h>
#include <thread>
#include <vector>

namespace slamsensor::tests {
namespace {

/// Keeps the compiler from leaving out an allocation that nobody uses.
void use(void* pointer) {
  asm volatile("" : : "g"(pointer) : "memory");
}

TEST(NoAllocScope, CountsEveryWayToTheHeap) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizer's heap cannot be watched";
  }
  const auto calls_of = [](const auto& work) {
    const NoAllocScope scope;
    work();
    return scope.heap_calls();
  };
  EXPECT_EQ(calls_of([] {}), 0U);
  void* p = nullptr;
  EXPECT_EQ(calls_of([&] { use(p = std::malloc(10)); }), 1U);
  EXPECT_EQ(calls_of([&] { use(p = std::realloc(p, 5000)); }), 1U);
  EXPECT_EQ(calls_of([&] { std::free(p); }), 1U);
  EXPECT_EQ(calls_of([&] { use(p = std::calloc(3, 5)); }), 1U);
  std::free(p);
  EXPECT_EQ(calls_of([&] { use(p = std::aligned_alloc(64, 128)); }), 1U);
  std::free(p);
  EXPECT_EQ(calls_of([&] { EXPECT_EQ(posix_memalign(&p, 64, 128), 0); }), 1U);
  std::free(p);
  EXPECT_EQ(calls_of([] { use(std::make_unique<int>(3).get()); }), 2U);
  struct alignas(128) Wide {
    char bytes[256];
  };
  EXPECT_EQ(calls_of([] { use(std::make_unique<Wide>().get()); }), 2U);
  EXPECT_EQ(calls_of([] { use(std::vector<int>(100).data()); }), 2U);
  EXPECT_EQ(calls_of([] { use(std::string(100, 'x').data()); }), 2U);
}

TEST(NoAllocScope, CountsItsOwnThreadOnly) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizer's heap cannot be watched";
  }
  std::uint64_t here = 1;
  std::uint64_t there = 0;
  const auto allocate = [&] {
    const NoAllocScope scope;
    use(std::make_unique<int>(3).get());
    there = scope.heap_calls();
  };
  const Cost cost = cost_of([&] {
    const NoAllocScope scope;
    here = scope.heap_calls();
  });
  std::thread(allocate).join();
  EXPECT_EQ(there, 2U);
  EXPECT_EQ(here, 0U);
  EXPECT_EQ(cost.heap_calls, 0U);
}

TEST(PageFaultScope, CountsTheFirstTouchOfAPage) {
  constexpr std::size_t kPages = 32;
  constexpr std::size_t kBytes = kPages * 4096;
  void* const block = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(block, MAP_FAILED);
  madvise(block, kBytes, MADV_NOHUGEPAGE);
  auto* const bytes = static_cast<volatile char*>(block);
  const auto touch = [&] {
    for (std::size_t i = 0; i < kBytes; i += 4096) {
      bytes[i] = 1;
    }
  };
  EXPECT_GE(cost_of(touch).page_faults, kPages);
  EXPECT_LT(cost_of(touch).page_faults, kPages) << "touched pages fault again";
  munmap(block, kBytes);
}

template <std::size_t kBytes>
[[gnu::noinline]] void spend_stack() {
  char bytes[kBytes];
  bytes[0] = 1;
  use(bytes);
}

TEST(PaintedStack, SeesHowFarDownTheWorkWrote) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: a sanitizer's frames are not those of the product";
  }
  const std::size_t little = cost_of(spend_stack<16>).stack_bytes;
  const std::size_t much = cost_of(spend_stack<100'000>).stack_bytes;
  EXPECT_LT(little, 4096U);
  EXPECT_GE(much, 100'000U);
  EXPECT_LT(much, 104'096U);
}

}  // namespace
}  // namespace slamsensor::tests
