#pragma once

#include "tests/support/no_alloc_scope.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace slamsensor::tests {

/// Runs `work` on a thread whose stack of `stack_bytes` was painted beforehand, hence is in memory, and
/// returns how far down `work` wrote: its stack in bytes, rounded up to a word. A stack that overflows ends
/// the process.
std::size_t run_on_painted_stack(std::size_t stack_bytes, const std::function<void()>& work);

/// Counts the page faults of its thread, minor and major, while it lives.
class PageFaultScope {
 public:
  PageFaultScope() noexcept;

  [[nodiscard]] std::uint64_t faults() const noexcept;

 private:
  std::uint64_t before_;
};

/// Brings every page that the process has mapped into memory, and keeps it there if it may: locked, or else
/// each mapping populated once. False when neither is to be had, and faults therefore say nothing.
[[nodiscard]] bool hold_memory();

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
