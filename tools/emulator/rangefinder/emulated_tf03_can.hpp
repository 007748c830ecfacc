#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/rangefinder/tf03_engine.hpp"

#include <cstdint>

namespace slamsensor::tools {

/// A Benewake TF03 at its CAN plug: a frame for each reading, commands and answers as on the UART, cut into
/// frames (TF03 manual V1.2.2, 4.2). It is deaf and mute while its flash says UART or another bit rate than
/// the bus has.
class EmulatedTf03Can final : public EmulatedCanDevice {
 public:
  /// `sink` and `scene` outlive the device.
  EmulatedTf03Can(const Tf03Settings& settings, FrameSink& sink, RangeScene& scene);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override { return engine_.next_event(); }

  /// Knows PowerCycle, Silence, NoReturns, WeakSignal, Saturation and StreamStops.
  bool inject(const Fault& fault) override { return engine_.inject(fault); }
  void receive(const hal::CanFrame& frame, Stamp at) override;

  [[nodiscard]] std::uint64_t records_sent() const { return engine_.outbox().sent(); }
  [[nodiscard]] std::uint64_t refused() const { return engine_.refused(); }

 private:
  class Line final : public OutboxLine {
   public:
    explicit Line(FrameSink& sink) : sink_(sink) {}
    void follow(const Tf03Parameters& parameters, bool is_on_bus);
    std::optional<Stamp> put(std::span<const std::uint8_t> bytes, Stamp at, Urgency urgency) override;

   private:
    FrameSink& sink_;
    std::uint32_t id_ = 0;
    bool extended_ = false;
    bool is_on_bus_ = true;
  };

  void follow_engine();
  [[nodiscard]] bool is_on_bus() const { return engine_.active().can_baud == settings_.bus_baud; }

  Tf03Settings settings_;
  Line line_;
  Tf03Engine engine_;
};

}  // namespace slamsensor::tools
