#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::firmware {

/// `value` is appended, most significant byte first.
template <std::integral T>
void append_big_endian(std::vector<std::uint8_t>& out, T value) {
  for (std::size_t i = sizeof(T); i > 0; --i) {
    out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * (i - 1))));
  }
}

/// The number in the first sizeof(T) bytes, most significant first; there are that many at least.
template <std::integral T>
[[nodiscard]] T read_big_endian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = (value << 8U) | bytes[i];
  }
  return static_cast<T>(value);
}

}  // namespace slamsensor::firmware
