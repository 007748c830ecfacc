#pragma once

#include <cstddef>
#include <cstdint>

namespace slamsensor::bench {

/// What the heap was asked for while a HeapWatch lived.
struct HeapUse {
  std::uint64_t allocations = 0;  ///< calls of malloc and its kin; operator new is one of them
  std::size_t peak_bytes = 0;     ///< most that was taken and not yet given back
};

/// Counts every heap allocation of the process, those of shared libraries included, from construction to
/// destruction. One at a time.
class HeapWatch {
 public:
  HeapWatch() noexcept;
  ~HeapWatch();
  HeapWatch(const HeapWatch&) = delete;
  HeapWatch& operator=(const HeapWatch&) = delete;

  [[nodiscard]] HeapUse use() const noexcept;
};

/// Whether an allocation, also one made in a shared library, is counted: a count of 0 means nothing
/// otherwise.
[[nodiscard]] bool heap_watch_works();

}  // namespace slamsensor::bench
