#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/rangefinder/serial_outbox_line.hpp"
#include "tools/emulator/rangefinder/tf03_engine.hpp"

#include <cstdint>

namespace slamsensor::tools {

/// A Benewake TF03 (or one of its relatives) at its UART: nine-byte frames and 5A commands (TF03 manuals V0.4
/// and V1.2.2, TFmini, TFmini Plus, TFmini-S and TF02 manuals). A command that it does not take is not
/// answered.
class EmulatedTf03 final : public EmulatedSerialDevice {
 public:
  /// `sink` and `scene` outlive the device.
  EmulatedTf03(const Tf03Settings& settings, ByteSink& sink, RangeScene& scene);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override { return engine_.next_event(); }

  /// Knows PowerCycle, Silence, BaudReset, NoReturns, WeakSignal, Saturation, BadChecksum, StreamStops,
  /// TextMessage, and of the TFmini-S DeviceError.
  bool inject(const Fault& fault) override;
  void receive(std::uint8_t byte, Stamp at) override;
  [[nodiscard]] std::uint32_t baud() const override { return line_.baud(); }

  /// Frames that were sent, and those that the line could not take.
  [[nodiscard]] std::uint64_t records_sent() const { return engine_.outbox().sent(); }
  [[nodiscard]] std::uint64_t records_dropped() const { return engine_.outbox().dropped(); }

  /// Commands that were refused: not whole, wrong sum, length, ID or value.
  [[nodiscard]] std::uint64_t refused() const { return engine_.refused(); }

 private:
  void follow_engine();

  Tf03Settings settings_;
  SerialOutboxLine line_;
  Tf03Engine engine_;
  std::uint32_t power_changes_ = 0;
};

}  // namespace slamsensor::tools
