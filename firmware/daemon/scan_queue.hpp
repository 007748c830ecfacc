#pragma once

#include "core/reading.hpp"
#include "firmware/scan/sensor_head.hpp"

#include <boost/lockfree/spsc_queue.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace slamsensor::firmware {

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
