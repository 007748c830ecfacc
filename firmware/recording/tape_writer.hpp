#pragma once

#include "firmware/recording/tape_format.hpp"

#include <span>
#include <vector>

namespace slamsensor::firmware {

/// Writes a tape into a buffer that is taken at construction; nothing is allocated later. One thread.
class TapeWriter {
 public:
  TapeWriter();

  /// The next operations belong to the step at `now`.
  void step(hal::Stamp now) noexcept;

  void link_state(std::uint8_t link, std::uint32_t epoch, bool is_up) noexcept;
  void read(std::uint8_t link, const hal::ByteRead& result, std::span<const std::uint8_t> bytes) noexcept;
  void read_down(std::uint8_t link, std::uint32_t epoch, bool is_up) noexcept;
  void write(std::uint8_t link, hal::LinkStatus status, std::span<const std::uint8_t> bytes) noexcept;
  void set_baud(std::uint8_t link, hal::LinkStatus status, std::uint32_t baud) noexcept;
  void discard(std::uint8_t link) noexcept;
  void can_receive(std::uint8_t link, const hal::CanRead& result) noexcept;
  void can_send(std::uint8_t link, hal::LinkStatus status, const hal::CanFrame& frame) noexcept;

  /// True when the chunk is long enough to be taken away; ask before each step.
  [[nodiscard]] bool is_due() const noexcept { return chunk_.size() >= kTapeChunkBytes; }

  /// What was written since the last clear().
  [[nodiscard]] std::span<const std::uint8_t> chunk() const noexcept { return chunk_; }

  /// Begins a new chunk; its first step tells its full time.
  void clear() noexcept;

  /// Operations that found no room: from there on the tape cannot be played.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

 private:
  /// Room for an operation with `bytes` bytes behind its numbers; counts a loss when there is none.
  [[nodiscard]] bool begin(TapeOp op, std::uint8_t link, std::size_t bytes) noexcept;
  void number(std::uint64_t value) noexcept;
  void signed_number(std::int64_t value) noexcept;
  void bytes(std::span<const std::uint8_t> data) noexcept;
  void frame(const hal::CanFrame& frame) noexcept;

  std::vector<std::uint8_t> chunk_;
  hal::Stamp now_{};
  bool is_fresh_ = true;
  std::uint64_t lost_ = 0;
};

}  // namespace slamsensor::firmware
