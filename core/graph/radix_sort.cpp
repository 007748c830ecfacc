#include "core/graph/radix_sort.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace slamsensor::core {
namespace {

constexpr std::uint32_t kDigitBits = 11;  // the counters of one digit fill a quarter of a level-1 cache

void sort_by_digit(std::span<const std::uint64_t> from, std::span<std::uint64_t> to, std::uint32_t shift,
                   std::uint32_t bits) noexcept {
  const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  std::array<std::uint32_t, std::size_t{1} << kDigitBits> next{};
  for (const std::uint64_t key : from) {
    ++next[(key >> shift) & mask];
  }
  std::uint32_t begin = 0;
  for (std::uint32_t& place : next) {
    const std::uint32_t count = place;
    place = begin;
    begin += count;
  }
  for (const std::uint64_t key : from) {
    to[next[(key >> shift) & mask]++] = key;
  }
}

}  // namespace

void radix_sort(std::span<std::uint64_t> keys, std::span<std::uint64_t> scratch, std::uint32_t first_bit,
                std::uint32_t last_bit) noexcept {
  SLAMSENSOR_ASSERT(scratch.size() >= keys.size() && first_bit <= last_bit && last_bit <= 64);
  std::span<std::uint64_t> from = keys;
  std::span<std::uint64_t> to = scratch.first(keys.size());
  for (std::uint32_t shift = first_bit; shift < last_bit; shift += kDigitBits) {
    sort_by_digit(from, to, shift, std::min(kDigitBits, last_bit - shift));
    std::swap(from, to);
  }
  if (from.data() != keys.data()) {
    std::copy(from.begin(), from.end(), keys.begin());
  }
}

}  // namespace slamsensor::core
