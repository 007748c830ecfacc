#pragma once

#include "hal/stamp.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {

/// Whether each thread of the daemon still makes progress. The threads beat, one watches.
class Heartbeats {
 public:
  static constexpr std::size_t kThreadsMax = 8;

  struct Thread {
    std::string_view name;     ///< lives as long as the program
    hal::Stamp silence_max{};  ///< it must beat at least this often
  };

  struct Stalled {
    std::string_view name;
    hal::Stamp silence{};
  };

  /// Adds a thread before any of them starts, and gives its number for beat(); none when there are
  /// kThreadsMax.
  [[nodiscard]] std::optional<std::size_t> add(const Thread& thread) noexcept;

  /// The thread of that number has made progress. Waits for nothing; safe on real-time threads.
  void beat(std::size_t thread) noexcept {
    if (thread < kThreadsMax) {
      beats_[thread].count.fetch_add(1, std::memory_order_relaxed);
    }
  }

  /// Looks at all threads; the one that has been silent longest beyond what it may, if there is one. Silence
  /// counts from the first look on. One thread, `now` never decreases.
  [[nodiscard]] std::optional<Stalled> check(hal::Stamp now) noexcept;

 private:
  struct alignas(64) Beat {  // a cache line each: threads on other cores do not disturb each other
    std::atomic<std::uint64_t> count{0};
  };
  struct Watched {
    Thread thread;
    std::uint64_t count = 0;
    hal::Stamp changed = -hal::kNever;
  };

  std::array<Beat, kThreadsMax> beats_{};
  std::array<Watched, kThreadsMax> watched_{};
  std::size_t size_ = 0;
};

}  // namespace slamsensor::firmware
