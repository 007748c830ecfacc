#pragma once

#include "hal/gpio/gpio.hpp"
#include "hal/init_error.hpp"
#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
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

enum class GpioDirection : std::uint8_t { Input, Output };

/// How a line is asked for.
struct GpioLineConfig {
  GpioDirection direction = GpioDirection::Input;
  GpioPolarity polarity = GpioPolarity::ActiveHigh;
  GpioBias bias = GpioBias::AsIs;  ///< inputs only
  GpioEdges edges = GpioEdges::None;
  Stamp debounce{};                         ///< zero: none; at most 1 s; see debounces_in_kernel()
  GpioLevel initial = GpioLevel::Inactive;  ///< outputs only
};

/// One line of the kernel's GPIO character device, held until destruction, by whichever libgpiod the program
/// was built with.
class GpioLine {
 public:
  /// The line as configured; the error names chip, line and reason (not found, no permission, busy by whom).
  [[nodiscard]] static tl::expected<GpioLine, InitError> open(const GpioAddress& address,
                                                              const GpioLineConfig& config);

  /// Whether the kernel debounces as GpioLineConfig says (libgpiod 2); else the setting has no effect.
  [[nodiscard]] static bool debounces_in_kernel() noexcept;

  GpioLine(GpioLine&&) noexcept;
  GpioLine& operator=(GpioLine&&) noexcept;
  ~GpioLine();

  /// Nothing when the chip is gone.
  [[nodiscard]] std::optional<GpioLevel> get() noexcept;
  [[nodiscard]] GpioStatus set(GpioLevel level) noexcept;

  /// Takes the oldest edge, with the kernel's time on CLOCK_MONOTONIC (Linux 5.7 and later); nothing
  /// when there is none. Only of a line whose edges were asked for.
  [[nodiscard]] std::optional<GpioEvent> read() noexcept;

  /// Becomes readable with an edge; -1 without edges.
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  struct Handle;  // libgpiod's objects

  GpioLine(std::unique_ptr<Handle> handle, int fd) noexcept;

  std::unique_ptr<Handle> handle_;
  int fd_ = -1;
};

}  // namespace slamsensor::hal
