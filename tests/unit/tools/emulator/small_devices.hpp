#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/scenario.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace slamsensor::tools {

using namespace std::chrono_literals;

/// Sends back every byte, `latency` later; PowerCycle is the only fault of its own that it knows.
class EchoDevice final : public EmulatedSerialDevice {
 public:
  EchoDevice(ByteSink& sink, std::uint32_t baud, Stamp latency = Stamp{})
      : sink_(sink), baud_(baud), latency_(latency) {}

  void advance(Stamp now) override { last_ = now; }
  [[nodiscard]] Stamp next_event() const override { return hal::kNever; }
  bool inject(const Fault& fault) override { return fault.kind == FaultKind::PowerCycle; }
  void receive(std::uint8_t byte, Stamp at) override {
    heard.push_back({byte, at});
    sink_.send(std::array{byte}, at + latency_);
  }
  [[nodiscard]] std::uint32_t baud() const override { return baud_; }
  void set_baud(std::uint32_t baud) { baud_ = baud; }

  struct Heard {
    std::uint8_t byte;
    Stamp at;
  };
  std::vector<Heard> heard;

 private:
  ByteSink& sink_;
  std::uint32_t baud_;
  Stamp latency_;
  Stamp last_{};
};

/// A pan-tilt unit that turns at a constant speed and has nothing to say.
class TurningUnit final : public EmulatedSerialDevice, public PointingTruth {
 public:
  explicit TurningUnit(double speed_radps) : speed_radps_(speed_radps) {}

  void advance(Stamp) override {}
  [[nodiscard]] Stamp next_event() const override { return hal::kNever; }
  bool inject(const Fault& fault) override { return fault.kind == FaultKind::MissedSteps; }
  void receive(std::uint8_t, Stamp) override {}
  [[nodiscard]] std::uint32_t baud() const override { return 9600; }
  [[nodiscard]] HeadAngles angles_at(Stamp at) const override {
    return {speed_radps_ * hal::to_seconds(at), -0.02};
  }

 private:
  double speed_radps_;
};

/// A rangefinder that shoots every millisecond and sends the range in cm, two bytes, low first; 0 for none.
class TickingLaser final : public EmulatedSerialDevice {
 public:
  TickingLaser(ByteSink& sink, RangeScene& scene) : sink_(sink), scene_(scene) {}

  void advance(Stamp now) override {
    for (; next_ <= now; next_ += 1ms) {
      const Target target = scene_.shoot(next_);
      const auto cm = static_cast<unsigned>(target.range_m * 100.0 + 0.5);
      sink_.send(std::array{static_cast<std::uint8_t>(cm), static_cast<std::uint8_t>(cm >> 8U)}, next_);
      scene_.reported(next_, next_);
    }
  }
  [[nodiscard]] Stamp next_event() const override { return next_; }
  bool inject(const Fault& fault) override { return fault.kind == FaultKind::NoReturns; }
  void receive(std::uint8_t, Stamp) override {}
  [[nodiscard]] std::uint32_t baud() const override { return 115'200; }

 private:
  ByteSink& sink_;
  RangeScene& scene_;
  Stamp next_ = 1ms;
};

/// A head of the two above.
[[nodiscard]] inline tl::expected<HeadDevices, WorldError> make_small_devices(const Scenario& scenario,
                                                                              RangeScene& scene) {
  HeadDevices devices;
  devices.ptu_port = std::make_unique<EmulatedPort>(scenario.seed);
  devices.rangefinder_port = std::make_unique<EmulatedPort>(scenario.seed + 1);
  auto unit = std::make_unique<TurningUnit>(0.5);
  auto laser = std::make_unique<TickingLaser>(*devices.rangefinder_port, scene);
  devices.ptu_port->attach(*unit);
  devices.rangefinder_port->attach(*laser);
  devices.pointing = unit.get();
  devices.ptu = std::move(unit);
  devices.rangefinder = std::move(laser);
  return devices;
}

}  // namespace slamsensor::tools
