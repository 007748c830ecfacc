#pragma once

#include "core/memory/arena.hpp"
#include "core/memory/assert.hpp"
#include "core/memory/checked_sequence.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>

namespace slamsensor::core {

/// A vector of plain values whose capacity is fixed at construction and whose storage is an arena's. It
/// cannot grow: `try_push_back` says so. Every access is checked. Movable handle, not copyable; use `assign`.
template <typename T>
class BoundedVector : public CheckedSequence<BoundedVector<T>, T> {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  BoundedVector(Arena& arena, const char* name, std::size_t capacity) noexcept
      : data_(arena.take<T>(name, capacity)), capacity_(capacity) {}
  BoundedVector(const BoundedVector&) = delete;
  BoundedVector& operator=(const BoundedVector&) = delete;
  BoundedVector(BoundedVector&&) noexcept = default;
  BoundedVector& operator=(BoundedVector&&) noexcept = default;

  /// False, and nothing changed, when the vector is full.
  [[nodiscard]] bool try_push_back(const T& value) noexcept {
    if (size_ == capacity_) {
      return false;
    }
    data_[size_++] = value;
    return true;
  }

  /// Sets the size; what new elements hold is not said. False, and nothing changed, when it exceeds the
  /// capacity.
  [[nodiscard]] bool try_resize(std::size_t size) noexcept {
    if (size > capacity_) {
      return false;
    }
    size_ = size;
    return true;
  }

  /// Sets the size; new elements are copies of `value`. False, and nothing changed, when it exceeds the
  /// capacity.
  [[nodiscard]] bool try_resize(std::size_t size, const T& value) noexcept {
    if (size > capacity_) {
      return false;
    }
    if (size > size_) {
      std::fill(data_ + size_, data_ + size, value);
    }
    size_ = size;
    return true;
  }

  /// Takes over `values`. False, and nothing changed, when they do not fit.
  [[nodiscard]] bool assign(std::span<const T> values) noexcept {
    if (values.size() > capacity_) {
      return false;
    }
    std::copy(values.begin(), values.end(), data_);
    size_ = values.size();
    return true;
  }

  /// Keeps the first `size` elements.
  void truncate(std::size_t size) noexcept {
    SLAMSENSOR_ASSERT(size <= size_);
    size_ = size;
  }
  void clear() noexcept { size_ = 0; }

  [[nodiscard]] T* data() noexcept { return data_; }
  [[nodiscard]] const T* data() const noexcept { return data_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] bool full() const noexcept { return size_ == capacity_; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace slamsensor::core
