#include "hal/transport/can_socket_config.hpp"

#include <algorithm>
#include <linux/can.h>
#include <net/if.h>

namespace slamsensor::hal {
namespace {

bool is_interface_name(const std::string& name) {
  return !name.empty() && name.size() < IFNAMSIZ && name != "." && name != ".." &&
         std::none_of(name.begin(), name.end(),
                      [](char c) { return c == '/' || c == ':' || c <= ' ' || c > '~'; });
}

}  // namespace

std::string complaint(const CanConfig& config) {
  if (!is_interface_name(config.interface)) {
    return "the name must be that of a network interface, 1 to 15 characters";
  }
  if (config.filters.size() > kCanFiltersMax) {
    return std::to_string(config.filters.size()) + " filters; at most " + std::to_string(kCanFiltersMax) +
           " are possible";
  }
  for (const CanFilter& filter : config.filters) {
    if ((filter.id | filter.mask) > (filter.extended ? CAN_EFF_MASK : CAN_SFF_MASK)) {
      return "a filter's id or mask has more than " + std::string(filter.extended ? "29" : "11") + " bits";
    }
  }
  if (!is_valid(config.reopen)) {
    return std::string(kReopenRule);
  }
  return {};
}

}  // namespace slamsensor::hal
