#pragma once

#include "core/memory/arena.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tests {

/// A T whose constructor takes an arena first, made as the product makes it: measured, then built in a block
/// of just that size.
template <typename T>
class InArena {
 public:
  template <typename... Args>
  explicit InArena(const Args&... args)
      : block_(lines_of(args...)),
        arena_(std::as_writable_bytes(std::span(block_))),
        value_(arena_, args...) {}
  InArena(const InArena&) = delete;
  InArena& operator=(const InArena&) = delete;

  T* operator->() { return &value_; }
  T& operator*() { return value_; }

 private:
  struct alignas(core::Arena::kAlignment) Line {
    std::byte bytes[core::Arena::kAlignment];
  };

  template <typename... Args>
  static std::size_t lines_of(const Args&... args) {
    core::Arena measuring;
    const auto measured = std::make_unique<T>(measuring, args...);
    return measuring.bytes_used() / core::Arena::kAlignment + 1;
  }

  std::vector<Line> block_;
  core::Arena arena_;
  T value_;
};

}  // namespace slamsensor::tests
