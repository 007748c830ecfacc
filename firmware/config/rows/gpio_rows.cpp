#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;

// Names of the enumerators, in their order.
constexpr std::string_view kPolarities[] = {"active_high", "active_low"};
constexpr std::string_view kBiases[] = {"as_is", "disabled", "pull_up", "pull_down"};

constexpr auto kDaemon = &Config::daemon;
constexpr auto kGpio = &DaemonConfig::gpio;

constexpr Section kSections[] = {
    {"gpio", "Lines of a GPIO chip that the sensor uses. A chip is \"/dev/gpiochip0\" or its label."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"gpio.trigger_chip", "", "Input whose active edge asks for one scan: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::chip>(kGpioChip)},
    {"gpio.trigger_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::line>(0, 1023)},
    {"gpio.trigger_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::polarity>(kPolarities)},
    {"gpio.trigger_bias", "", "Pull resistor of the chip.",
     choice<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::bias>(kBiases)},
    {"gpio.trigger_debounce_s", "s", "Shorter changes are not seen.",
     real<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::debounce_s>(0.0, 1.0)},
    {"gpio.interlock_chip", "", "Input that allows scanning while active: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::chip>(kGpioChip)},
    {"gpio.interlock_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::line>(0, 1023)},
    {"gpio.interlock_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::polarity>(kPolarities)},
    {"gpio.interlock_bias", "", "Pull resistor of the chip.",
     choice<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::bias>(kBiases)},
    {"gpio.interlock_debounce_s", "s", "Shorter changes are not seen.",
     real<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::debounce_s>(0.0, 1.0)},
    {"gpio.led_chip", "", "Output on with a fix, blinking while devices are missing: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::led, &GpioOutputSetting::chip>(kGpioChip)},
    {"gpio.led_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::led, &GpioOutputSetting::line>(0, 1023)},
    {"gpio.led_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::led, &GpioOutputSetting::polarity>(kPolarities)},
    {"gpio.pulse_chip", "", "Output active for pulse_s at each new fix: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::pulse, &GpioOutputSetting::chip>(kGpioChip)},
    {"gpio.pulse_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::pulse, &GpioOutputSetting::line>(0, 1023)},
    {"gpio.pulse_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::pulse, &GpioOutputSetting::polarity>(kPolarities)},
    {"gpio.pulse_s", "s", "Length of that pulse.",
     real<kDaemon, kGpio, &GpioConfig::pulse_s>(0.001, 10.0)},
};
// clang-format on

}  // namespace

SettingRows gpio_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
