#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace slamsensor::hal {

/// First in, first out, at most `kCapacity` values, in place. One thread.
template <typename T, std::size_t kCapacity>
class Ring {
 public:
  /// Appends `value`; false, and nothing changes, when the ring is full.
  [[nodiscard]] bool try_push(const T& value) noexcept {
    if (size_ == kCapacity) {
      return false;
    }
    values_[(first_ + size_) % kCapacity] = value;
    ++size_;
    return true;
  }

  /// Moves the oldest values into `into`; returns how many.
  std::size_t take(std::span<T> into) noexcept {
    std::size_t count = 0;
    while (count < into.size() && size_ > 0) {
      into[count++] = values_[first_];
      first_ = (first_ + 1) % kCapacity;
      --size_;
    }
    return count;
  }

  void clear() noexcept { size_ = 0; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::array<T, kCapacity> values_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace slamsensor::hal
