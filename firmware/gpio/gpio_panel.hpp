#pragma once

#include "firmware/config/daemon_config.hpp"
#include "firmware/gpio/gpio_inputs.hpp"
#include "firmware/gpio/gpio_outputs.hpp"
#include "hal/gpio/open_gpio.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <functional>
#include <memory>

namespace slamsensor::firmware {

/// How a panel gets its lines: the kernel's, or whatever stands in for them.
struct GpioOpeners {
  std::function<tl::expected<std::unique_ptr<hal::GpioInput>, hal::InitError>(const hal::GpioInputConfig&)>
      input = hal::open_gpio_input;
  std::function<tl::expected<std::unique_ptr<hal::GpioOutput>, hal::InitError>(const hal::GpioOutputConfig&)>
      output = hal::open_gpio_output;
};

/// The lines of a GPIO chip that the sensor has to the outer world. Its two halves share nothing: the inputs
/// are the scan thread's, the outputs the publish thread's.
class GpioPanel {
 public:
  /// The lines that `config` names, LED and pulse dark. The error says which setting, chip and line, and what
  /// to do. A panel without any line does nothing.
  [[nodiscard]] static tl::expected<std::unique_ptr<GpioPanel>, hal::InitError> open(
      const GpioConfig& config, const GpioOpeners& openers = {});

  [[nodiscard]] GpioInputs& inputs() noexcept { return inputs_; }
  [[nodiscard]] GpioOutputs& outputs() noexcept { return outputs_; }

 private:
  GpioPanel(GpioInputLines inputs, GpioOutputLines outputs, hal::Stamp pulse) noexcept;

  GpioInputs inputs_;
  GpioOutputs outputs_;
};

}  // namespace slamsensor::firmware
