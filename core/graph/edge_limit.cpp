#include "core/graph/edge_limit.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>

namespace slamsensor::core {

void EdgeLimit::show(EdgeRank rank) noexcept {
  ++shown_;
  const std::uint32_t digit_bits = std::min(kDigitBits, open_bits_);
  const std::uint32_t shift = open_bits_ - digit_bits;
  if (((rank ^ limit_) >> shift) >> digit_bits == 0) {
    ++counts_[static_cast<std::size_t>((rank ^ limit_) >> shift)];
  }
}

// The limit lies in the first bucket that has more edges than there is room left. Ranks differ, so with the
// last bits a bucket holds one edge and the room is used up exactly.
void EdgeLimit::end_pass() noexcept {
  total_ = shown_;
  const std::uint32_t shift = open_bits_ - std::min(kDigitBits, open_bits_);
  std::size_t bucket = 0;
  while (counts_[bucket] <= room_) {
    room_ -= counts_[bucket++];
    SLAMSENSOR_ASSERT(bucket < counts_.size());
  }
  limit_ |= static_cast<EdgeRank>(bucket) << shift;
  open_bits_ = shift;
  settled_ = room_ == 0;
  SLAMSENSOR_ASSERT(settled_ || open_bits_ > 0);
  shown_ = 0;
  counts_.fill(0);
}

}  // namespace slamsensor::core
