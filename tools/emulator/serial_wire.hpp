#pragma once

#include "hal/stamp.hpp"
#include "tools/emulator/fault.hpp"
#include "tools/emulator/uart_sampler.hpp"
#include "tools/world/random.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

namespace slamsensor::tools {

/// One direction of a serial line, 8N1: what is sent arrives ten bit times later for each byte, in order. A
/// receiver at a rate that is off by more than 3 % gets what its UART would make of the levels. Equal seeds
/// and calls, equal arrivals.
class SerialWire {
 public:
  explicit SerialWire(std::uint64_t seed) : rng_(seed) {}

  /// `bytes` follow what was sent before, the first not before `at`, with ten bit times at `baud` for each.
  void send(std::span<const std::uint8_t> bytes, hal::Stamp at, std::uint32_t baud);

  /// Takes the oldest byte that has arrived by `now` at a receiver of `receiver_baud`. Every send() after
  /// this call is at `now` or later.
  [[nodiscard]] std::optional<WireByte> next(hal::Stamp now, std::uint32_t receiver_baud);

  /// The earliest time at which next() would give a byte if nothing more were sent; hal::kNever for none.
  [[nodiscard]] hal::Stamp next_arrival(std::uint32_t receiver_baud) const;

  /// When the last byte sent has left; a time in the past when the line is idle.
  [[nodiscard]] hal::Stamp busy_until() const noexcept { return busy_until_; }

  /// Forgets what was sent and has not arrived.
  void clear();

  /// Lets a line fault (DropByte to Stall) begin at its time; false for every other kind. All that arrived
  /// before was taken.
  bool inject(const Fault& fault);

 private:
  void put(std::uint8_t value, hal::Stamp at, std::uint32_t baud);
  void put_again_from(hal::Stamp from);
  [[nodiscard]] bool is_read_whole(const LineByte& byte, std::uint32_t receiver_baud) const noexcept;
  [[nodiscard]] hal::Stamp line_arrival(std::uint32_t receiver_baud) const;
  void drop_sampled();
  [[nodiscard]] std::optional<WireByte> next_of_line(hal::Stamp now, std::uint32_t receiver_baud);
  [[nodiscard]] std::optional<WireByte> disturbed(WireByte byte, std::uint32_t receiver_baud);
  [[nodiscard]] WireByte noise_byte(std::uint32_t receiver_baud);
  void draw_noise_gap(std::uint32_t receiver_baud);

  Random rng_;
  std::deque<LineByte> line_;
  hal::Stamp sampled_until_ = hal::Stamp::min();  // the receiver has looked at the line up to here
  hal::Stamp busy_until_{};
  hal::Stamp run_begin_{};  // of the bytes that follow each other without a gap
  std::uint32_t run_count_ = 0;
  std::uint32_t run_baud_ = 0;
  hal::Stamp noise_until_ = hal::Stamp::min();
  hal::Stamp next_noise_ = hal::kNever;
  std::optional<WireByte> doubled_;
  std::uint32_t drops_ = 0;
  std::uint32_t corruptions_ = 0;
  std::uint32_t doubles_ = 0;
};

}  // namespace slamsensor::tools
