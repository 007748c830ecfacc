#pragma once

#include "hal/stamp.hpp"
#include "hal/transport/byte_link.hpp"
#include "hal/transport/reopen.hpp"
#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/fault.hpp"
#include "tools/world/random.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

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

/// An emulated device on a serial line, with the host's end of that line. Bytes take their time in both
/// directions; the cable can be pulled.
class EmulatedPort final : public EmulatedLine, public ByteSink {
 public:
  explicit EmulatedPort(std::uint64_t seed);

  /// `device`, which was given this port as its ByteSink and outlives its use, is on the line from now on.
  void attach(EmulatedSerialDevice& device) { device_ = &device; }

  // The host's end. Call advance(now) before.

  [[nodiscard]] bool is_plugged() const noexcept { return plugged_; }

  /// Grows by one each time the cable is plugged in; 1 at the beginning.
  [[nodiscard]] std::uint32_t plug_count() const noexcept { return plug_count_; }

  /// The device's line rate; nothing without a device.
  [[nodiscard]] std::optional<std::uint32_t> device_baud() const {
    return device_ != nullptr ? std::optional(device_->baud()) : std::nullopt;
  }

  /// The host's line rate for what it sends and hears from now on, bit/s.
  void set_host_baud(std::uint32_t baud) noexcept { host_baud_ = baud; }
  [[nodiscard]] std::uint32_t host_baud() const noexcept { return host_baud_; }

  /// Puts `bytes` on the line after those before; lost while the cable is out.
  void host_write(std::span<const std::uint8_t> bytes, Stamp now);

  /// When the line has taken all that the host wrote.
  [[nodiscard]] Stamp host_busy_until() const noexcept { return to_device_.busy_until(); }

  /// Moves the oldest bytes that arrived at `until` or before into `into`; returns how many.
  std::size_t host_take(std::span<WireByte> into, Stamp until);

  /// Throws away what has arrived.
  void host_discard() noexcept { arrived_.clear(); }

  /// Bytes that were lost because the host did not take them (it keeps 64 Ki).
  [[nodiscard]] std::uint64_t overruns() const noexcept { return overruns_; }

  /// Ends a CableOut at once; nothing when the cable is in.
  void plug_in();

  // EmulatedLine
  [[nodiscard]] Stamp next_event() const override;
  [[nodiscard]] Stamp next_delivery() const override;
  void advance(Stamp now) override;
  bool inject(const Fault& fault) override;

  // ByteSink, the device's end
  void send(std::span<const std::uint8_t> bytes, Stamp at) override;
  [[nodiscard]] Stamp busy_until() const override { return to_host_.busy_until(); }
  void clear() override { to_host_.clear(); }

 private:
  void step(Stamp event);
  void deliver(Stamp now);
  void pull_cable(const Fault& fault);

  SerialWire to_host_;
  SerialWire to_device_;
  EmulatedSerialDevice* device_ = nullptr;
  std::deque<WireByte> arrived_;
  std::uint64_t overruns_ = 0;
  std::uint32_t host_baud_ = 9600;
  std::uint32_t plug_count_ = 1;
  bool plugged_ = true;
  Stamp plug_at_ = hal::kNever;
  EventGuard guard_;
};

struct MemoryLinkConfig {
  std::uint32_t baud = 9600;
  hal::Stamp batch{};              ///< arrivals are handed over at its multiples, as a USB adapter does
                                   ///< every 1, 4 or 16 ms; 0: each byte at once
  std::size_t write_queue = 4096;  ///< bytes that wait for the line at most
  hal::ReopenConfig reopen;
};

/// The host's end of an EmulatedPort in simulated time, with the manners of a serial port: it is opened by
/// service(), lost when the cable is pulled, and opened again with back-off. The port was advanced to the
/// clock's time before each call.
class MemoryLink final : public hal::ByteLink {
 public:
  /// Both outlive the link.
  MemoryLink(EmulatedPort& port, const SimClock& clock, const MemoryLinkConfig& config);

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return epoch_; }
  [[nodiscard]] bool is_up() const noexcept override { return up_; }
  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override;
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override;

  /// Down for a rate below 50 or above 4,000,000 bit/s.
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] std::uint32_t baud() const noexcept override { return config_.baud; }
  void discard_input() noexcept override;

 private:
  bool is_lost() noexcept;
  [[nodiscard]] hal::Stamp handed_over_until() const noexcept;
  [[nodiscard]] std::size_t queued() const noexcept;

  EmulatedPort& port_;
  const SimClock& clock_;
  MemoryLinkConfig config_;
  hal::ReopenTimer timer_;
  std::uint32_t epoch_ = 0;
  std::uint32_t plug_count_ = 0;  // of the port when it was opened
  bool up_ = false;
};

}  // namespace slamsensor::tools
