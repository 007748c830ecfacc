#include "firmware/gpio/gpio_panel.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr hal::GpioPolarity polarity_of(GpioPolaritySetting setting) noexcept {
  return setting == GpioPolaritySetting::ActiveHigh ? hal::GpioPolarity::ActiveHigh
                                                    : hal::GpioPolarity::ActiveLow;
}

constexpr hal::GpioBias bias_of(GpioBiasSetting setting) noexcept {
  switch (setting) {
    case GpioBiasSetting::AsIs:
      break;
    case GpioBiasSetting::Disabled:
      return hal::GpioBias::Disabled;
    case GpioBiasSetting::PullUp:
      return hal::GpioBias::PullUp;
    case GpioBiasSetting::PullDown:
      return hal::GpioBias::PullDown;
  }
  return hal::GpioBias::AsIs;
}

hal::InitError named(std::string_view setting, const hal::InitError& error) {
  return {std::string(setting) + ": " + error.message};
}

/// The input of `setting`; null when it names no chip.
tl::expected<std::unique_ptr<hal::GpioInput>, hal::InitError> open_input(const GpioInputSetting& setting,
                                                                         hal::GpioEdges edges,
                                                                         std::string_view name,
                                                                         const GpioOpeners& openers) {
  if (setting.chip.empty()) {
    return nullptr;
  }
  hal::GpioInputConfig config;
  config.address = {setting.chip, std::to_string(setting.line)};
  config.polarity = polarity_of(setting.polarity);
  config.bias = bias_of(setting.bias);
  config.edges = edges;
  config.debounce = hal::from_seconds(setting.debounce_s);
  return openers.input(config).map_error([&](const hal::InitError& error) { return named(name, error); });
}

tl::expected<std::unique_ptr<hal::GpioOutput>, hal::InitError> open_output(const GpioOutputSetting& setting,
                                                                           std::string_view name,
                                                                           const GpioOpeners& openers) {
  if (setting.chip.empty()) {
    return nullptr;
  }
  hal::GpioOutputConfig config;
  config.address = {setting.chip, std::to_string(setting.line)};
  config.polarity = polarity_of(setting.polarity);
  return openers.output(config).map_error([&](const hal::InitError& error) { return named(name, error); });
}

}  // namespace

tl::expected<std::unique_ptr<GpioPanel>, hal::InitError> GpioPanel::open(const GpioConfig& config,
                                                                         const GpioOpeners& openers) {
  auto trigger = open_input(config.trigger, hal::GpioEdges::ToActive, "gpio.trigger", openers);
  if (!trigger) {
    return tl::unexpected(trigger.error());
  }
  // Both edges are asked for, so that an opening between two polls is seen.
  auto interlock = open_input(config.interlock, hal::GpioEdges::Both, "gpio.interlock", openers);
  if (!interlock) {
    return tl::unexpected(interlock.error());
  }
  auto led = open_output(config.led, "gpio.led", openers);
  if (!led) {
    return tl::unexpected(led.error());
  }
  auto pulse = open_output(config.pulse, "gpio.pulse", openers);
  if (!pulse) {
    return tl::unexpected(pulse.error());
  }
  return std::unique_ptr<GpioPanel>(new GpioPanel({std::move(*trigger), std::move(*interlock)},
                                                  {std::move(*led), std::move(*pulse)},
                                                  hal::from_seconds(config.pulse_s)));
}

GpioPanel::GpioPanel(GpioInputLines inputs, GpioOutputLines outputs, hal::Stamp pulse) noexcept
    : inputs_(std::move(inputs)), outputs_(std::move(outputs), pulse) {
}

}  // namespace slamsensor::firmware
