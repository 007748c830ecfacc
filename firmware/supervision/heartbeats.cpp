#include "firmware/supervision/heartbeats.hpp"

namespace slamsensor::firmware {

std::optional<std::size_t> Heartbeats::add(const Thread& thread) noexcept {
  if (size_ == kThreadsMax) {
    return std::nullopt;
  }
  watched_[size_].thread = thread;
  return size_++;
}

std::optional<Heartbeats::Stalled> Heartbeats::check(hal::Stamp now) noexcept {
  std::optional<Stalled> worst;
  hal::Stamp worst_excess{};
  for (std::size_t i = 0; i < size_; ++i) {
    Watched& watched = watched_[i];
    const std::uint64_t count = beats_[i].count.load(std::memory_order_relaxed);
    if (count != watched.count || watched.changed == -hal::kNever) {
      watched.count = count;
      watched.changed = now;
    }
    const hal::Stamp silence = now - watched.changed;
    const hal::Stamp excess = silence - watched.thread.silence_max;
    if (excess > worst_excess) {
      worst_excess = excess;
      worst = Stalled{watched.thread.name, silence};
    }
  }
  return worst;
}

}  // namespace slamsensor::firmware
