#include "hal/timing/arrival_log.hpp"

namespace slamsensor::hal {

void ArrivalLog::note(std::size_t count, Stamp stamp) noexcept {
  position_ += count;
  newest_ = (newest_ + 1) % kReads;
  reads_[newest_] = {position_, stamp};
  count_ = count_ < kReads ? count_ + 1 : kReads;
}

Stamp ArrivalLog::latest_begin(std::uint64_t begin, std::uint64_t end, std::uint32_t baud) const noexcept {
  Read holder = reads_[newest_];
  for (std::size_t back = 1; back < count_; ++back) {
    const Read& earlier = reads_[(newest_ + kReads - back) % kReads];
    if (earlier.end < end) {
      break;
    }
    holder = earlier;
  }
  return holder.stamp - line_time(static_cast<std::size_t>(holder.end - begin), baud);
}

}  // namespace slamsensor::hal
