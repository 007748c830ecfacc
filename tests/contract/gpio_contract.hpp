#pragma once

#include "hal/gpio/gpio.hpp"
#include "tests/contract/rig.hpp"
#include "tests/support/fake_gpio.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace slamsensor::tests {

/// A chip with one line whose far end the test drives, and one that it looks at. Each is asked for at most
/// once at a time.
class GpioRig : public Rig {
 public:
  [[nodiscard]] virtual std::unique_ptr<hal::GpioInput> input(const FakeGpioConfig& config) = 0;
  [[nodiscard]] virtual std::unique_ptr<hal::GpioOutput> output(hal::GpioPolarity polarity,
                                                                hal::GpioLevel initial) = 0;

  /// Puts the input's wire to a voltage.
  virtual void drive(Wire wire) = 0;

  /// The voltage of the output's wire.
  [[nodiscard]] virtual Wire seen() = 0;

  /// Whether the lines keep hal's promise to take no memory.
  [[nodiscard]] virtual bool promises_no_heap() const { return true; }
};

using GpioRigMaker = RigMaker<GpioRig>;

/// The contract of hal::GpioInput and hal::GpioOutput.
class GpioContract : public testing::TestWithParam<GpioRigMaker> {
 protected:
  void SetUp() override;

  /// Waits for `count` events of `input`, up to 10 s; what came.
  [[nodiscard]] std::vector<hal::GpioEvent> events(hal::GpioInput& input, std::size_t count);

  std::unique_ptr<GpioRig> rig_;
};

}  // namespace slamsensor::tests
