#pragma once

#include "hal/stamp.hpp"

#include <cstdint>
#include <deque>
#include <optional>

namespace slamsensor::tools {

/// A byte and the moment at which it has arrived completely.
struct WireByte {
  std::uint8_t value = 0;
  hal::Stamp at{};
};

/// A character (start bit, eight data bits from the lowest, stop bit) on a line.
struct LineByte {
  std::uint8_t value = 0;
  hal::Stamp begin{};
  hal::Stamp end{};
  std::uint32_t baud = 9600;  ///< of the sender
};

/// True when a receiver of `receiver_baud` reads characters sent at `sender_baud` as they were sent.
[[nodiscard]] bool rates_agree(std::uint32_t sender_baud, std::uint32_t receiver_baud) noexcept;

/// True when a start bit may begin in `byte` at `from` or later.
[[nodiscard]] bool has_falling_edge(const LineByte& byte, hal::Stamp from) noexcept;

/// Where a UART at `baud`, idle at `from`, begins to wait anew when it has passed every falling edge that is
/// no start bit and whose judgement falls due by `now`; `from` when there is none.
[[nodiscard]] hal::Stamp skip_glitches(const std::deque<LineByte>& line, hal::Stamp from, hal::Stamp now,
                                       std::uint32_t baud);

/// The first character that a UART at `baud`, idle at `from`, makes of `line` (in order of time, idle high in
/// between): it waits for a falling edge, checks the middle of the start bit, and samples the middle of every
/// bit. A stop bit that is low reads as a zero byte, as from a Linux tty that neither ignores nor marks
/// framing errors. `at` is the middle of the stop bit. Nothing when no character begins.
[[nodiscard]] std::optional<WireByte> sample_character(const std::deque<LineByte>& line, hal::Stamp from,
                                                       std::uint32_t baud);

}  // namespace slamsensor::tools
