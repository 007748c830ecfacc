#pragma once

#include "hal/gpio/gpio.hpp"
#include "hal/gpio/gpio_line.hpp"
#include "hal/init_error.hpp"
#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <memory>

namespace slamsensor::hal {

struct GpioInputConfig {
  GpioAddress address;
  GpioPolarity polarity = GpioPolarity::ActiveHigh;
  GpioBias bias = GpioBias::AsIs;
  GpioEdges edges = GpioEdges::Both;
  Stamp debounce{};  ///< zero: none; at most 1 s
};

struct GpioOutputConfig {
  GpioAddress address;
  GpioPolarity polarity = GpioPolarity::ActiveHigh;
  GpioLevel initial = GpioLevel::Inactive;
};

/// An input of the kernel's GPIO character device, this program's until destruction. Debounced by the kernel
/// with libgpiod 2, here with libgpiod 1. The error names chip, line and reason.
[[nodiscard]] tl::expected<std::unique_ptr<GpioInput>, InitError> open_gpio_input(
    const GpioInputConfig& config);

/// An output, at its initial level; after destruction the line's level is the chip's affair.
[[nodiscard]] tl::expected<std::unique_ptr<GpioOutput>, InitError> open_gpio_output(
    const GpioOutputConfig& config);

}  // namespace slamsensor::hal
