#pragma once

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Sorts `keys` by their bits [first_bit, last_bit) and keeps the order of keys that agree in them. `scratch`
/// must be at least as long as `keys`. Linear time, no recursion.
void radix_sort(std::span<std::uint64_t> keys, std::span<std::uint64_t> scratch, std::uint32_t first_bit,
                std::uint32_t last_bit) noexcept;

}  // namespace slamsensor::core
