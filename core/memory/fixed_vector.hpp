#pragma once

#include "core/memory/assert.hpp"
#include "core/memory/checked_sequence.hpp"

#include <array>
#include <cstddef>

namespace slamsensor::core {

/// A vector of at most N values in place. It cannot overflow: `try_push_back` says when it is full. Every
/// access is checked. Trivially copyable when T is, so that it may stand in arenas and queues
/// (boost::container::static_vector is not, and asserts or throws on overflow).
template <typename T, std::size_t N>
class FixedVector : public CheckedSequence<FixedVector<T, N>, T> {
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

  [[nodiscard]] T* data() noexcept { return values_.data(); }
  [[nodiscard]] const T* data() const noexcept { return values_.data(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }

 private:
  std::array<T, N> values_{};
  std::size_t size_ = 0;
};

}  // namespace slamsensor::core
