#pragma once

#include "hal/transport/byte_link.hpp"
#include "hal/transport/reopen.hpp"
#include "tools/emulator/emulated_port.hpp"
#include "tools/emulator/sim_clock.hpp"

#include <cstddef>
#include <cstdint>

namespace slamsensor::tools {

struct MemoryLinkConfig {
  std::uint32_t baud = 9600;
  hal::Stamp batch{};              ///< arrivals are handed over at multiples of it, as a USB adapter does
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
