#pragma once

#include "hal/gpio/gpio.hpp"

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>

namespace slamsensor::tests {

/// The voltage on a wire.
enum class Wire : std::uint8_t { Low, High };

struct FakeGpioConfig {
  hal::GpioPolarity polarity = hal::GpioPolarity::ActiveHigh;
  hal::GpioBias bias = hal::GpioBias::AsIs;
  hal::GpioEdges edges = hal::GpioEdges::Both;
  hal::Stamp debounce{};
};

/// An input whose wire the test drives; it reports a change as the kernel does, to 16 of them.
class FakeGpioInput final : public hal::GpioInput {
 public:
  /// The wire is low, or where the bias pulls it.
  explicit FakeGpioInput(const FakeGpioConfig& config = {});

  /// The wire is at `wire` from `at` on, which is not before the last call.
  void drive(Wire wire, hal::Stamp at);

  /// The chip is gone: the line cannot be read any more.
  void remove_chip() { is_gone_ = true; }

  std::optional<hal::GpioLevel> level(hal::Stamp now) noexcept override;
  std::optional<hal::GpioEvent> next_event(hal::Stamp now) noexcept override;
  int fd() const noexcept override { return -1; }
  std::span<const hal::Counter> counters() const noexcept override { return counters_; }

 private:
  void report(const std::optional<hal::GpioEvent>& event);

  FakeGpioConfig config_;
  Wire wire_;
  hal::Debouncer debouncer_;
  std::deque<hal::GpioEvent> events_;
  std::array<hal::Counter, 1> counters_{hal::Counter{"edges_lost", 0}};
  bool is_gone_ = false;
};

/// An output whose wire the test looks at.
class FakeGpioOutput final : public hal::GpioOutput {
 public:
  explicit FakeGpioOutput(hal::GpioPolarity polarity = hal::GpioPolarity::ActiveHigh,
                          hal::GpioLevel initial = hal::GpioLevel::Inactive)
      : polarity_(polarity), level_(initial) {}

  [[nodiscard]] Wire wire() const;
  void remove_chip() { is_gone_ = true; }

  hal::GpioStatus set(hal::GpioLevel level) noexcept override;
  hal::GpioLevel level() const noexcept override { return level_; }

 private:
  hal::GpioPolarity polarity_;
  hal::GpioLevel level_;
  bool is_gone_ = false;
};

}  // namespace slamsensor::tests
