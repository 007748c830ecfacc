#pragma once

#include "tools/emulator/device_line.hpp"
#include "tools/emulator/serial_wire.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

namespace slamsensor::tools {

/// An emulated device on a serial line, with the host's end of that line. Bytes take their time in both
/// directions; the cable can be pulled.
class EmulatedPort final : public DeviceLine, public ByteSink {
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

  // DeviceLine
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

}  // namespace slamsensor::tools
