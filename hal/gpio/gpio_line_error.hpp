#pragma once

#include "hal/init_error.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::hal {

/// Where a line is.
struct GpioAddress {
  std::string chip;  ///< "/dev/gpiochip0"
  std::string line;  ///< its offset on the chip ("17"), or its name
};

/// The offset, when the line is given by one.
[[nodiscard]] std::optional<unsigned int> offset_of(const GpioAddress& address) noexcept;

/// "GPIO line 17 of /dev/gpiochip0: `what`".
[[nodiscard]] InitError gpio_error(const GpioAddress& address, std::string_view what);

/// `step` failed with `error`, an errno; and what to do.
[[nodiscard]] InitError gpio_failure(const GpioAddress& address, std::string_view step, int error);

/// The line belongs to `owner`, as the kernel names it; null or empty when it does not.
[[nodiscard]] InitError gpio_busy(const GpioAddress& address, const char* owner);

}  // namespace slamsensor::hal
