#pragma once

#include "hal/transport/reopen.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace slamsensor::hal {

enum class SerialParity : std::uint8_t { None, Even, Odd };

/// How a character looks on the line, between one start bit and the stop bits.
struct SerialFormat {
  std::uint8_t data_bits = 8;  ///< 7 or 8
  SerialParity parity = SerialParity::None;
  std::uint8_t stop_bits = 1;  ///< 1 or 2
};

enum class Rs485Level : std::uint8_t { Low, High };
enum class Rs485Echo : std::uint8_t { Off, On };

/// Two-wire line whose driver is switched by RTS (Linux: struct serial_rs485).
struct Rs485Config {
  Rs485Level rts_while_sending = Rs485Level::High;
  Rs485Level rts_after_sending = Rs485Level::Low;
  std::uint32_t delay_before_send_ms = 0;  ///< at most 1000
  std::uint32_t delay_after_send_ms = 0;   ///< at most 1000
  Rs485Echo receive_own = Rs485Echo::Off;  ///< whether what is sent is also received
};

enum class SerialLatency : std::uint8_t { AsIs, Low };

struct SerialLine {
  std::uint32_t baud = 9600;
  SerialFormat format;
};

/// What the settings of a line came to. `error` is an errno.
enum class LineStatus : std::uint8_t {
  Done,
  Failed,         ///< a system call failed with `error`
  RateRefused,    ///< the hardware runs at another rate
  FormatRefused,  ///< the hardware keeps another format
};

struct LineResult {
  LineStatus status = LineStatus::Done;
  int error = 0;
};

/// Makes the terminal `fd` a raw line: every byte passes as it is in both directions, no flow control, no
/// modem lines, a read without data fails with EAGAIN and one after a hang-up returns 0; then reads the
/// settings back, for the kernel reports success when only some were taken. A rate may be off by 3 %.
/// Pseudo-terminals keep 8 data bits without parity whatever is set, which is no failure.
[[nodiscard]] LineResult make_raw(int fd, const SerialLine& line) noexcept;

/// Whether the terminal still has these settings, or another program has changed them.
[[nodiscard]] bool has_settings(int fd, const SerialLine& line) noexcept;

/// Changes the rate alone, bit/s; the rate before stays when it is refused.
[[nodiscard]] LineResult change_rate(int fd, std::uint32_t baud) noexcept;

/// Whether all that was written has left the line, as far as the driver can tell.
[[nodiscard]] bool has_sent_all(int fd) noexcept;

/// Asks the driver to hand over bytes at once (ASYNC_LOW_LATENCY); an errno, 0 when it does.
[[nodiscard]] int ask_low_latency(int fd) noexcept;

/// Sets the RS-485 mode; an errno, 0 when the driver took it.
[[nodiscard]] int set_rs485(int fd, const Rs485Config& config) noexcept;

[[nodiscard]] bool is_pseudo_terminal(int fd) noexcept;

/// Allows nobody else to open the terminal (root aside), or anybody again.
enum class Exclusive : std::uint8_t { Off, On };
[[nodiscard]] int set_exclusive(int fd, Exclusive exclusive) noexcept;

/// Throw away what has arrived, and what is waiting to be sent.
void flush_input(int fd) noexcept;
void flush_output(int fd) noexcept;

struct SerialConfig {
  std::string path;   ///< a stable one: a link of /dev/serial/by-id, by-path or an own udev rule
  SerialLine line{};  ///< 50 to 12,000,000 bit/s
  std::optional<Rs485Config> rs485{};
  SerialLatency latency = SerialLatency::Low;
  ReopenConfig reopen{};
};

[[nodiscard]] constexpr bool is_line_rate(std::uint32_t baud) noexcept {
  return baud >= 50 && baud <= 12'000'000;
}

/// What is wrong with `config`, in words that follow the port's name; empty when nothing is.
[[nodiscard]] std::string complaint(const SerialConfig& config);

}  // namespace slamsensor::hal
