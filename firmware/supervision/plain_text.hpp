#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

[[nodiscard]] constexpr bool is_control(char c) noexcept {
  return static_cast<unsigned char>(c) < 0x20 || c == '\x7f';
}

/// `text` with '?' for every control character: fit for one line of a log, an answer or a status.
[[nodiscard]] inline std::string plain_text(std::string_view text) {
  std::string plain(text);
  std::replace_if(plain.begin(), plain.end(), is_control, '?');
  return plain;
}

}  // namespace slamsensor::firmware
