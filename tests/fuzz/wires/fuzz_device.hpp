#pragma once

#include "tools/emulator/emulated_device.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::tests {

/// A line that counts what a device sends.
class FuzzSink final : public tools::ByteSink {
 public:
  void send(std::span<const std::uint8_t> bytes, hal::Stamp at) override {
    busy_until_ = std::max(busy_until_, at) + hal::line_time(bytes.size(), device->baud());
  }
  [[nodiscard]] hal::Stamp busy_until() const override { return busy_until_; }
  void clear() override { busy_until_ = hal::Stamp{}; }

  const tools::EmulatedSerialDevice* device = nullptr;

 private:
  hal::Stamp busy_until_{};
};

/// A scene with something at 12.34 m.
class FuzzScene final : public tools::RangeScene {
 public:
  tools::Target shoot(hal::Stamp) override { return {tools::TargetKind::Target, 12.34, 0.3}; }
  void reported(hal::Stamp, hal::Stamp) override {}
};

/// The host's bytes come one each millisecond. The device must not be behind its line by more than a second.
template <typename Device, typename Settings>
void talk_to(const Settings& settings, std::span<const std::uint8_t> bytes) {
  FuzzSink sink;
  FuzzScene scene;
  Device device(settings, sink, scene);
  sink.device = &device;
  hal::Stamp now{};
  for (const std::uint8_t byte : bytes) {
    now += std::chrono::milliseconds(1);
    device.advance(now);
    device.receive(byte, now);
    if (device.baud() == 0 || sink.busy_until() > now + std::chrono::seconds(1)) {
      __builtin_trap();
    }
  }
}

}  // namespace slamsensor::tests
