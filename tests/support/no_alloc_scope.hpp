#pragma once

#include <cstdint>

namespace slamsensor::tests {

/// Counts what its thread asks of the heap while it lives: allocations and releases, by whatever name
/// (malloc, new, aligned_alloc, ...). A binary that is to use it links no_alloc_scope.cpp, whose functions
/// take the place of the C library's in the whole process.
class NoAllocScope {
 public:
  /// Whether the heap can be watched: not under the sanitizers, which bring their own.
  [[nodiscard]] static bool works() noexcept;

  NoAllocScope() noexcept;

  /// Allocations, reallocations and releases of the calling thread since construction.
  [[nodiscard]] std::uint64_t heap_calls() const noexcept;

 private:
  std::uint64_t before_;
};

}  // namespace slamsensor::tests
