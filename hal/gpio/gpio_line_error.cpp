#include "hal/gpio/gpio_line_error.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>

namespace slamsensor::hal {
namespace {

std::string advice_for(int error) {
  switch (error) {
    case ENOENT:
      return "; correct the chip or line in the configuration (gpioinfo lists them)";
    case EACCES:
    case EPERM:
      return "; let this user use the chip (group gpio or a udev rule)";
    case ENOTTY:
    case ENODEV:
      return "; this is no GPIO chip";
    case EINVAL:
      return "; the chip cannot do what is configured (bias, edges or debounce)";
    default:
      return {};
  }
}

}  // namespace

std::optional<unsigned int> offset_of(const GpioAddress& address) noexcept {
  const char* const end = address.line.data() + address.line.size();
  unsigned int offset = 0;
  const auto [stop, problem] = std::from_chars(address.line.data(), end, offset);
  if (problem != std::errc{} || stop != end) {
    return std::nullopt;
  }
  return offset;
}

InitError gpio_error(const GpioAddress& address, std::string_view what) {
  return {"GPIO line " + address.line + " of " + address.chip + ": " + std::string(what)};
}

InitError gpio_failure(const GpioAddress& address, std::string_view step, int error) {
  return gpio_error(address, std::string(step) + ": " + std::strerror(error) + advice_for(error));
}

InitError gpio_busy(const GpioAddress& address, const char* owner) {
  const bool is_known = owner != nullptr && *owner != '\0';
  const std::string who = is_known ? "\"" + std::string(owner) + "\"" : "the kernel or another program";
  return gpio_error(address, "in use by " + who + "; free it or configure another line");
}

}  // namespace slamsensor::hal
