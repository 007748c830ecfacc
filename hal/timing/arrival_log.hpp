#pragma once

#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::hal {

/// When the bytes of a serial line arrived, told by their place in the stream, which counts from 0.
class ArrivalLog {
 public:
  /// `count` more bytes were read at `stamp`, which does not decrease.
  void note(std::size_t count, Stamp stamp) noexcept;

  /// Place of the byte that comes next.
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }

  /// The latest moment at which the record of the bytes [begin, end) can have begun on a line of `baud`
  /// bit/s: the line also had to carry the record and all that the same read brought after it. Never earlier
  /// than the truth; later when the record was read too long ago for the log to know when. begin < end <=
  /// position().
  [[nodiscard]] Stamp latest_begin(std::uint64_t begin, std::uint64_t end, std::uint32_t baud) const noexcept;

 private:
  struct Read {
    std::uint64_t end = 0;  ///< place after the last byte of the read
    Stamp stamp{};
  };
  static constexpr std::size_t kReads = 64;

  std::array<Read, kReads> reads_{};
  std::size_t newest_ = 0;
  std::size_t count_ = 0;
  std::uint64_t position_ = 0;
};

}  // namespace slamsensor::hal
