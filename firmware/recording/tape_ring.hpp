#pragma once

#include "firmware/recording/tape_sink.hpp"

#include <boost/lockfree/spsc_queue.hpp>

#include <cstddef>

namespace slamsensor::firmware {

/// Carries chunks from the thread that writes a tape to the one that saves it, without a lock. All memory
/// (32 kB per chunk) is taken at construction.
class TapeRing final : public TapeSink {
 public:
  /// Room for `chunks`, at least 1.
  explicit TapeRing(std::size_t chunks) : queue_(chunks) {}

  [[nodiscard]] bool take(const TapeChunk& chunk) noexcept override { return queue_.push(chunk); }

  /// Gives every chunk that is there to `save(const TapeChunk&)`, the oldest first. On the saving thread.
  template <typename Save>
  void drain(const Save& save) {
    while (queue_.consume_one(save)) {
    }
  }

 private:
  boost::lockfree::spsc_queue<TapeChunk> queue_;
};

}  // namespace slamsensor::firmware
