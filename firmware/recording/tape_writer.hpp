#pragma once

#include "firmware/recording/tape_format.hpp"

#include <boost/lockfree/spsc_queue.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace slamsensor::firmware {

/// Writes one tape, chunk by chunk, into a sink. Its memory is taken at construction. A chunk that the sink
/// refuses is lost, counted, and noted at the start of the next one. One thread.
class TapeWriter {
 public:
  /// `sink` outlives the writer.
  explicit TapeWriter(TapeSink& sink);

  /// `link` stands like this before its driver is made.
  void open(HeadLink link, const TapeLinkState& state) noexcept;

  /// The operations that follow belong to the step at `now`, which never decreases.
  void step(hal::Stamp now) noexcept;

  void service(HeadLink link, const TapeLinkState& state) noexcept;
  void after(HeadLink link, const TapeLinkState& state) noexcept;

  /// `data` is what was read, of at most kTapeBytesMax bytes; empty unless the status is Ok.
  void read(HeadLink link, const hal::ByteRead& result, std::span<const std::uint8_t> data) noexcept;
  void write(HeadLink link, hal::LinkStatus status, std::span<const std::uint8_t> data) noexcept;
  void set_baud(HeadLink link, hal::LinkStatus status, std::uint32_t baud) noexcept;
  void discard(HeadLink link) noexcept;
  void can_receive(HeadLink link, const hal::CanRead& result) noexcept;
  void can_send(HeadLink link, hal::LinkStatus status, const hal::CanFrame& frame) noexcept;

  /// `what` is given to the scan head between the step before and the next.
  void command(TapeCommand what, std::uint64_t argument = 0) noexcept;

  /// Ends the tape and hands its last chunk out; false when the sink has no room: try again. Nothing may be
  /// written afterwards.
  [[nodiscard]] bool finish() noexcept;

  /// Operations that were lost: from the first of them on the tape cannot be played.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

 private:
  /// Makes room for an operation with `bytes` bytes behind its numbers, and begins it.
  void begin(TapeOp op, HeadLink link, std::size_t bytes) noexcept;
  void hand_out() noexcept;
  void put(std::uint8_t byte) noexcept { chunk_->data[chunk_->size++] = byte; }
  void number(std::uint64_t value) noexcept;
  void signed_number(std::int64_t value) noexcept;
  void bytes(std::span<const std::uint8_t> data) noexcept;
  void state(const TapeLinkState& state) noexcept;
  void frame(const hal::CanFrame& frame) noexcept;

  TapeSink& sink_;
  std::unique_ptr<TapeChunk> chunk_;
  std::uint64_t operations_ = 0;  // in chunk_
  std::uint64_t lost_ = 0;
  std::uint64_t lost_told_ = 0;
  hal::Stamp now_{};
  hal::Stamp period_{};  // between the last two steps
  bool is_first_step_ = true;
  bool has_ended_ = false;
};

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
