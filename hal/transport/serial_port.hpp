#pragma once

#include "hal/counters.hpp"
#include "hal/fixed_text.hpp"
#include "hal/init_error.hpp"
#include "hal/transport/byte_link.hpp"
#include "hal/transport/reopen.hpp"
#include "hal/transport/serial_line.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::hal {

using DeviceGroup = FixedText<32>;

/// The name by which /proc/devices knows the character device at `path` ("ttyUSB"), as systemd's
/// DeviceAllow=char- takes it; empty when there is none. Takes no memory.
[[nodiscard]] DeviceGroup device_group(const char* path) noexcept;

enum class SerialEvent : std::uint8_t {
  Opened,
  OpenFailed,
  HangUp,             ///< the device went away (unplugged, far end of a pseudo-terminal closed)
  IoError,            ///< a read or write failed otherwise; the port is opened again
  PartialWrite,       ///< the kernel took only some bytes; the port sends the rest by itself
  QueueFull,          ///< writes that were refused because bytes still waited
  OversizedWrite,     ///< writes that can never fit, refused
  RateRefused,        ///< line rates out of bounds or not kept by the hardware
  LowLatencyRefused,  ///< the driver has no such mode; a pseudo-terminal never has
  Rs485Refused,       ///< by a pseudo-terminal, which works without
  SettingsRestored,   ///< another program had changed the rate, the format or the mode
  NameMoved,          ///< the path leads to another device than the one that is open
};

/// A terminal device as a raw line of bytes, this program's alone. It is opened by service(), at the first
/// call and, with back-off, again after every loss, by the same path; also within a second when that path
/// leads to another device, as a stable name does after the cable was changed. What another program makes of
/// its settings (only root can) is undone within a tenth of a second.
class SerialPort final : public ByteLink {
 public:
  /// The most bytes that one write takes.
  static constexpr std::size_t kWriteMax = 4096;

  /// A port that is down until service() has opened it, so a device may come later; an error only when the
  /// configuration cannot be right.
  [[nodiscard]] static tl::expected<std::unique_ptr<SerialPort>, InitError> create(
      const SerialConfig& config);

  ~SerialPort() override;

  void service(Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return epoch_; }
  [[nodiscard]] bool is_up() const noexcept override { return fd_ >= 0; }
  [[nodiscard]] ByteRead read(std::span<std::uint8_t> into) noexcept override;
  [[nodiscard]] LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override;

  /// As in ByteLink. What was written before still leaves at the old rate: while it does, writes are Busy.
  LinkStatus set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] std::uint32_t baud() const noexcept override;
  void discard_input() noexcept override;

  /// What to wait on with poll() until bytes arrive; -1 while the port is down. Changes when it is reopened.
  [[nodiscard]] int fd() const noexcept { return fd_; }

  /// Why the port is down and what to do, for a person; empty when it is up. Lives until the next call of a
  /// function that is not const.
  [[nodiscard]] std::string_view problem() const noexcept override { return problem_.view(); }

  [[nodiscard]] std::span<const Counter> counters() const noexcept override { return counters_.all(); }

 private:
  static constexpr std::size_t kEvents = static_cast<std::size_t>(SerialEvent::NameMoved) + 1;

  explicit SerialPort(const SerialConfig& config);

  void open(Stamp now) noexcept;
  [[nodiscard]] std::optional<OpenFailure> prepare(int fd) noexcept;
  [[nodiscard]] std::optional<OpenFailure> make_rs485(int fd) noexcept;
  void close() noexcept;
  void lose(SerialEvent why, int error) noexcept;
  void look_for_hang_up() noexcept;
  [[nodiscard]] LinkStatus failed_io(int error) noexcept;
  [[nodiscard]] LinkStatus send_rest() noexcept;
  void apply_next_baud() noexcept;
  void keep_settings(Stamp now) noexcept;
  void follow_name(Stamp now) noexcept;

  const SerialConfig config_;
  std::uint32_t baud_;
  std::uint32_t next_baud_ = 0;  ///< 0: none; else the rate once the bytes written before are gone
  int fd_ = -1;
  std::uint32_t epoch_ = 0;
  Stamp settings_due_{};  ///< when the terminal's settings are looked at next
  Stamp name_due_{};      ///< when the path is looked up next
  bool is_lost_ = false;  ///< found lost since the last service()
  ReopenTimer timer_;
  ReopenProblem problem_;
  std::array<std::uint8_t, kWriteMax> rest_{};  ///< of a write that the kernel took in part
  std::span<const std::uint8_t> unsent_;        ///< in `rest_`
  EventCounters<SerialEvent, kEvents> counters_;
};

}  // namespace slamsensor::hal
