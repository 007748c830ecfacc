#include "firmware/config/config_error.hpp"

#include <algorithm>
#include <iterator>

namespace slamsensor::firmware {

std::string Origin::short_text() const {
  if (is_default()) {
    return "default";
  }
  return line == 0 ? file : file + ':' + std::to_string(line);
}

std::string ConfigError::text() const {
  std::string line = place.is_default() ? "configuration" : place.file;
  if (place.line != 0) {
    line += ':' + std::to_string(place.line) + ':' + std::to_string(place.column);
  }
  return line + ": " + (key.empty() ? "" : key + ": ") + message;
}

std::string printable(std::string_view text, std::size_t size_max) {
  std::size_t size = std::min(text.size(), size_max);
  while (size < text.size() && size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) {
    --size;  // not within a character of UTF-8
  }
  std::string shown(text.substr(0, size));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; },
      '?');
  return text.size() > size ? shown + "..." : shown;
}

void append(std::vector<ConfigError>& errors, std::vector<ConfigError> more) {
  errors.insert(errors.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::string error_lines(const std::vector<ConfigError>& errors) {
  std::string lines;
  for (const ConfigError& error : errors) {
    lines += error.text() + '\n';
  }
  return lines;
}

}  // namespace slamsensor::firmware
