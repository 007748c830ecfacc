#pragma once

#include "core/memory/assert.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace slamsensor::core {

/// A vector of at most N values in place. It cannot overflow: `try_push_back` says when it is full. Every
/// access is checked. Trivially copyable when T is, so that it may stand in arenas and queues
/// (boost::container::static_vector is not, and asserts or throws on overflow).
template <typename T, std::size_t N>
class FixedVector {
 public:
  /// False, and nothing changed, when the vector is full.
  [[nodiscard]] bool try_push_back(const T& value) noexcept {
    if (size_ == N) {
      return false;
    }
    values_[size_++] = value;
    return true;
  }

  /// Keeps the first `size` elements.
  void truncate(std::size_t size) noexcept {
    SLAMSENSOR_ASSERT(size <= size_);
    size_ = size;
  }
  void clear() noexcept { size_ = 0; }

  [[nodiscard]] T& operator[](std::size_t i) noexcept {
    SLAMSENSOR_ASSERT(i < size_);
    return values_[i];
  }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept {
    SLAMSENSOR_ASSERT(i < size_);
    return values_[i];
  }
  [[nodiscard]] T& back() noexcept { return (*this)[size_ - 1]; }
  [[nodiscard]] const T& back() const noexcept { return (*this)[size_ - 1]; }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] T* begin() noexcept { return values_.data(); }
  [[nodiscard]] T* end() noexcept { return values_.data() + size_; }
  [[nodiscard]] const T* begin() const noexcept { return values_.data(); }
  [[nodiscard]] const T* end() const noexcept { return values_.data() + size_; }
  [[nodiscard]] std::span<const T> span() const noexcept { return {values_.data(), size_}; }

 private:
  std::array<T, N> values_{};
  std::size_t size_ = 0;
};

}  // namespace slamsensor::core
