#pragma once

#include <string>
#include <string_view>

namespace slamsensor::firmware {

[[nodiscard]] constexpr bool is_control(char c) noexcept {
  return static_cast<unsigned char>(c) < 0x20 || c == '\x7f';
}

/// `text` with '?' for every control character and for every byte that is not UTF-8: fit for one line of a
/// log, an answer or a status.
[[nodiscard]] std::string plain_text(std::string_view text);

/// `value` with `decimals` digits behind the point, whatever the locale; -0.0 has no sign. "unknown" when it
/// is not finite.
[[nodiscard]] std::string decimal_text(double value, int decimals);

}  // namespace slamsensor::firmware
