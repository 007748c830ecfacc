#include "firmware/config/rules.hpp"

namespace slamsensor::firmware {

std::vector<ConfigError> check_config(const LoadedConfig& loaded, const std::vector<ConfigError>& known) {
  Rules rules(loaded, known);
  check_head(rules);
  check_method(rules);
  check_daemon(rules);
  return rules.take_errors();
}

}  // namespace slamsensor::firmware
