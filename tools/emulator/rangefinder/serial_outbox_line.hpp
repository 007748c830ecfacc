#pragma once

#include "tools/emulator/rangefinder/outbox.hpp"

#include <cstdint>

namespace slamsensor::tools {

/// A serial line behind a transmit buffer: a record that does not fit into what is free of the buffer is
/// dropped whole, as devices do whose line is too slow for their rate.
class SerialOutboxLine final : public OutboxLine {
 public:
  SerialOutboxLine(ByteSink& sink, std::uint32_t buffer_bytes) : sink_(sink), buffer_bytes_(buffer_bytes) {}

  /// The line rate for what follows, bit/s.
  void set_baud(std::uint32_t baud) { baud_ = baud; }
  [[nodiscard]] std::uint32_t baud() const { return baud_; }

  /// What is in the buffer is lost.
  void clear() { sink_.clear(); }

  std::optional<Stamp> put(std::span<const std::uint8_t> bytes, Stamp at, Urgency urgency) override;

 private:
  ByteSink& sink_;
  std::uint32_t buffer_bytes_;
  std::uint32_t baud_ = 115200;
};

}  // namespace slamsensor::tools
