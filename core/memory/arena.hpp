#pragma once

#include "core/memory/assert.hpp"
#include "core/memory/fixed_vector.hpp"

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <type_traits>

namespace slamsensor::core {

/// One line of the memory plan: `count` objects taken under `name`, `bytes` including alignment padding.
struct MemoryPlanEntry {
  const char* name;
  std::size_t count;
  std::size_t bytes;
};

/// Hands out typed arrays from one block and never gives them back (DESIGN 2.7). Without a block it measures:
/// every array is null, but the plan and the total are those that the same calls take from a real block.
/// Constructors therefore only take arrays and must not touch them when `measuring()`. One thread.
class Arena {
 public:
  static constexpr std::size_t kAlignment = 64;  // a cache line, so that no two arrays share one
  static constexpr std::size_t kPlanEntriesMax = 128;
  using Plan = FixedVector<MemoryPlanEntry, kPlanEntriesMax>;

  /// A measuring arena: `bytes_used()` is the size of the block that the measured calls need.
  Arena() noexcept = default;

  /// An arena over `block`, which must be aligned to kAlignment and outlive all that is taken from it.
  explicit Arena(std::span<std::byte> block) noexcept : block_(block) {
    SLAMSENSOR_ASSERT(reinterpret_cast<std::uintptr_t>(block.data()) % kAlignment == 0);
  }

  /// `count` value-initialised objects of T, or null when measuring. A block too small for what was measured
  /// is a broken invariant and stops the process.
  template <typename T>
  [[nodiscard]] T* take(const char* name, std::size_t count) noexcept {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment);
    const std::size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
    const std::size_t begin = used_;
    used_ += bytes;
    SLAMSENSOR_ASSERT(plan_.try_push_back(MemoryPlanEntry{name, count, bytes}));
    if (measuring()) {
      return nullptr;
    }
    SLAMSENSOR_ASSERT(used_ <= block_.size());
    T* const first = reinterpret_cast<T*>(block_.data() + begin);
    for (std::size_t i = 0; i < count; ++i) {
      ::new (static_cast<void*>(first + i)) T();
    }
    return first;
  }

  [[nodiscard]] bool measuring() const noexcept { return block_.data() == nullptr; }
  [[nodiscard]] std::size_t bytes_used() const noexcept { return used_; }
  [[nodiscard]] const Plan& plan() const noexcept { return plan_; }

 private:
  std::span<std::byte> block_;
  std::size_t used_ = 0;
  Plan plan_;
};

}  // namespace slamsensor::core
