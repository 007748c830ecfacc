#pragma once

#include "tests/rt/page_faults.hpp"
#include "tests/rt/painted_stack.hpp"
#include "tests/support/no_alloc_scope.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace slamsensor::tests {

/// What a piece of work cost its thread.
struct Cost {
  std::uint64_t heap_calls = 0;
  std::uint64_t page_faults = 0;
  std::size_t stack_bytes = 0;
};

inline constexpr std::size_t kRehearsalStack_bytes = 1024 * 1024;

/// Runs `work` on a prefaulted stack of its own and says what it cost.
inline Cost cost_of(const std::function<void()>& work) {
  Cost cost;
  cost.stack_bytes = run_on_painted_stack(kRehearsalStack_bytes, [&] {
    const PageFaultScope faults;
    const NoAllocScope heap;
    work();
    cost.heap_calls = heap.heap_calls();
    cost.page_faults = faults.faults();
  });
  return cost;
}

}  // namespace slamsensor::tests
