#pragma once

#include "core/reading.hpp"
#include "firmware/scan/sensor_head.hpp"

#include <boost/lockfree/spsc_queue.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace slamsensor::firmware {

/// The newest value of T, handed from one writing thread to one reading thread; neither ever waits, and a
/// value is never seen half written. Values in between are lost. Three T, taken at construction.
template <typename T>
class Mailbox {
 public:
  Mailbox() = default;
  /// Three copies of `blank`.
  explicit Mailbox(const T& blank) : slots_{blank, blank, blank} {}

  /// Where the writer makes the next value; what stands there is some older one.
  [[nodiscard]] T& draft() noexcept { return slots_[writing_]; }
  /// The draft is the newest value from now on.
  void post() noexcept {
    writing_ = shared_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) &
               kIndexMask;
  }

  /// Takes the newest value; false when there was none since the last call.
  [[nodiscard]] bool refresh() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) == 0) {
      return false;
    }
    reading_ = shared_.exchange(reading_, std::memory_order_acq_rel) & kIndexMask;
    return true;
  }
  /// The value that was taken last; the blank one before the first.
  [[nodiscard]] const T& value() const noexcept { return slots_[reading_]; }

 private:
  static constexpr std::uint8_t kIndexMask = 3;
  static constexpr std::uint8_t kFresh = 4;

  std::array<T, 3> slots_{};
  std::uint8_t writing_ = 0;
  std::atomic<std::uint8_t> shared_{1};
  std::uint8_t reading_ = 2;
};

/// From the scan thread to the SLAM thread: bounded, first in first out, neither waits. A scanline that finds
/// no room is dropped and counted; beginnings and ends of scans have room of their own.
class ScanQueue {
 public:
  /// Room for `scanlines` scanlines of together 2 * `readings_per_line_max` readings, written to from end to
  /// end: no later use meets a page fault.
  ScanQueue(std::size_t scanlines, std::size_t readings_per_line_max);

  /// Scan thread: copies `event` to the end. False when it was dropped.
  bool push(const HeadEvent& event) noexcept;

  /// SLAM thread: the oldest event, which frees the readings of the one before; none when there is none. Of a
  /// scanline `readings` are valid until the next call, and `stamps` are left out.
  [[nodiscard]] std::optional<HeadEvent> take() noexcept;

  /// Any thread: nothing lies in it at this moment.
  [[nodiscard]] bool is_empty() const noexcept { return entries_.read_available() == 0; }

  /// Scanlines (any thread) and other messages that found no room, since construction.
  [[nodiscard]] std::uint64_t scanlines_dropped() const noexcept { return scanlines_dropped_.load(); }
  [[nodiscard]] std::uint64_t messages_dropped() const noexcept { return messages_dropped_.load(); }

 private:
  [[nodiscard]] bool push_line(Scanline line) noexcept;
  [[nodiscard]] std::optional<std::size_t> room_for(std::size_t count) const noexcept;

  std::vector<core::Reading> readings_;
  boost::lockfree::spsc_queue<HeadEvent> entries_;
  std::size_t write_ = 0;               // scan thread: where the next readings go
  std::atomic<std::size_t> read_{0};    // up to here the SLAM thread has no more use for them
  std::optional<std::size_t> release_;  // SLAM thread: what `read_` becomes at the next take
  std::atomic<std::uint64_t> scanlines_dropped_{0};
  std::atomic<std::uint64_t> messages_dropped_{0};
};

}  // namespace slamsensor::firmware
