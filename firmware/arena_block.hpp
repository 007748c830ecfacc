#pragma once

#include "core/memory/arena.hpp"

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

namespace slamsensor::firmware {

/// A T of core with the one block of memory that it asks for (DESIGN 2.7): measured, taken, written to from
/// end to end, so that no later use meets a page fault, and T built in it as T(arena, arguments...). The
/// constructor throws std::bad_alloc when the system has not so much memory.
template <typename T>
class ArenaBlock {
 public:
  template <typename... Arguments>
  explicit ArenaBlock(const Arguments&... arguments) {
    core::Arena measuring;
    (void)std::make_unique<T>(measuring, arguments...);
    const std::size_t bytes = measuring.bytes_used();
    block_.reset(static_cast<std::byte*>(std::aligned_alloc(core::Arena::kAlignment, bytes)));
    if (!block_) {
      throw std::bad_alloc();
    }
    std::memset(block_.get(), 0, bytes);
    core::Arena arena({block_.get(), bytes});
    value_ = std::make_unique<T>(arena, arguments...);
  }

  [[nodiscard]] T* operator->() { return value_.get(); }
  [[nodiscard]] const T& operator*() const { return *value_; }

 private:
  struct Free {
    void operator()(std::byte* block) const { std::free(block); }  // NOLINT: from aligned_alloc
  };
  std::unique_ptr<std::byte, Free> block_;
  std::unique_ptr<T> value_;
};

}  // namespace slamsensor::firmware
