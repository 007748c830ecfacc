#pragma once

#include "core/memory/assert.hpp"

#include <cstddef>
#include <span>

namespace slamsensor::core {

/// What the containers of fixed capacity have in common: checked access to `Derived`'s data() and size().
template <typename Derived, typename T>
class CheckedSequence {
 public:
  [[nodiscard]] T& operator[](std::size_t i) noexcept {
    SLAMSENSOR_ASSERT(i < self().size());
    return self().data()[i];
  }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept {
    SLAMSENSOR_ASSERT(i < self().size());
    return self().data()[i];
  }
  [[nodiscard]] T& back() noexcept { return (*this)[self().size() - 1]; }
  [[nodiscard]] const T& back() const noexcept { return (*this)[self().size() - 1]; }
  [[nodiscard]] bool empty() const noexcept { return self().size() == 0; }
  [[nodiscard]] T* begin() noexcept { return self().data(); }
  [[nodiscard]] T* end() noexcept { return self().data() + self().size(); }
  [[nodiscard]] const T* begin() const noexcept { return self().data(); }
  [[nodiscard]] const T* end() const noexcept { return self().data() + self().size(); }
  [[nodiscard]] std::span<T> span() noexcept { return {self().data(), self().size()}; }
  [[nodiscard]] std::span<const T> span() const noexcept { return {self().data(), self().size()}; }

 private:
  [[nodiscard]] Derived& self() noexcept { return static_cast<Derived&>(*this); }
  [[nodiscard]] const Derived& self() const noexcept { return static_cast<const Derived&>(*this); }
};

}  // namespace slamsensor::core
