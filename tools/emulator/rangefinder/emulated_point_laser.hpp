#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/rangefinder/laser_machine.hpp"
#include "tools/emulator/rangefinder/point_commands.hpp"
#include "tools/emulator/rangefinder/serial_outbox_line.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// A laser that writes one record for each reading on a serial line: ASTECH LDS70A or LDM41E with their
/// commands, or any other that only streams (PointSettings). One look into the scene for each reading,
/// however many pulses it averages.
class EmulatedPointLaser final : public EmulatedSerialDevice {
 public:
  /// `sink` and `scene` outlive the device.
  EmulatedPointLaser(const PointSettings& settings, ByteSink& sink, RangeScene& scene);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override { return machine_.next_event(); }

  /// Knows PowerCycle, Silence, BaudReset, NoReturns, WeakSignal, Saturation, TextMessage, DeviceError and,
  /// if it has commands, StreamStops. Its records have no checksum.
  bool inject(const Fault& fault) override;
  void receive(std::uint8_t byte, Stamp at) override;
  [[nodiscard]] std::uint32_t baud() const override { return line_.baud(); }

  /// Records that were sent, and those that the line could not take.
  [[nodiscard]] std::uint64_t records_sent() const { return machine_.outbox.sent(); }
  [[nodiscard]] std::uint64_t records_dropped() const { return machine_.outbox.dropped(); }

 private:
  void step(Stamp now);
  void start_up(Stamp now);
  void go_down(Stamp until);
  void take_line(std::string_view line, Stamp at);
  void act(PointAction action, Stamp at);
  void follow_baud();
  void put_text(std::string_view text, Stamp at);
  void build_record(Stamp at);
  [[nodiscard]] PointReading read(const Sight& sight);

  PointSettings settings_;
  RangeScene& scene_;
  SerialOutboxLine line_;
  LaserMachine machine_;
  PointCommands commands_;
  std::string text_;
  PointReading last_;
  std::vector<std::uint8_t> record_;
};

}  // namespace slamsensor::tools
