#pragma once

#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::hal {

enum class LinkStatus : std::uint8_t {
  Ok,
  Busy,  ///< nothing has arrived, or there is no room to send; try again later
  Down,  ///< the link is lost; service() is bringing it back
};

struct ByteRead {
  LinkStatus status = LinkStatus::Busy;
  std::size_t count = 0;
  Stamp stamp{};  ///< moment of the read: every byte had arrived by then
};

/// A serial line to one device: bytes in, bytes out, no waiting. One thread.
class ByteLink {
 public:
  ByteLink() = default;
  ByteLink(const ByteLink&) = delete;
  ByteLink& operator=(const ByteLink&) = delete;
  virtual ~ByteLink() = default;

  /// Brings a lost link back, with back-off. Call it at every step, before reading.
  virtual void service(Stamp now) noexcept = 0;

  /// Grows by one each time the link comes up; 0 before the first time. A driver that sees it grow starts
  /// over.
  [[nodiscard]] virtual std::uint32_t epoch() const noexcept = 0;

  [[nodiscard]] virtual bool is_up() const noexcept = 0;

  /// What keeps it down and what to do, for a person; empty when it is up or nothing is known. Valid until
  /// the next call of service().
  [[nodiscard]] virtual std::string_view problem() const noexcept { return {}; }

  /// Counts of losses, errors and refusals, by names; none where nothing is counted.
  [[nodiscard]] virtual std::span<const Counter> counters() const noexcept { return {}; }

  /// Takes the oldest bytes that have arrived, at most into.size(). Ok means count > 0.
  [[nodiscard]] virtual ByteRead read(std::span<std::uint8_t> into) noexcept = 0;

  /// Sends all of `bytes` (Ok) or none (Busy, Down). What is Ok is on its way to the line, after what went
  /// before.
  [[nodiscard]] virtual LinkStatus write(std::span<const std::uint8_t> bytes) noexcept = 0;

  /// Changes the line rate, bit/s, for what follows; kept over a loss of the link. Down when the link is down
  /// (the rate is then used when it comes back) or the hardware refuses the rate.
  virtual LinkStatus set_baud(std::uint32_t baud) noexcept = 0;
  [[nodiscard]] virtual std::uint32_t baud() const noexcept = 0;

  /// Throws away what has arrived and was not read.
  virtual void discard_input() noexcept = 0;
};

}  // namespace slamsensor::hal
