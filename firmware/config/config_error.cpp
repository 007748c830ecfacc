#include "firmware/config/config_error.hpp"

namespace slamsensor::firmware {

std::string ConfigError::text() const {
  std::string line = place.is_default() ? "configuration" : place.file;
  if (place.line != 0) {
    line += ':' + std::to_string(place.line) + ':' + std::to_string(place.column);
  }
  return line + ": " + (key.empty() ? "" : key + ": ") + message;
}

std::string error_lines(const std::vector<ConfigError>& errors) {
  std::string lines;
  for (const ConfigError& error : errors) {
    lines += error.text() + '\n';
  }
  return lines;
}

}  // namespace slamsensor::firmware
