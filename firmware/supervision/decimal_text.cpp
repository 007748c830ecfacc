#include "firmware/supervision/decimal_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace slamsensor::firmware {

std::string decimal_text(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "unknown";
  }
  std::array<char, 400> digits{};  // the largest double has 309 in front of the point
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
  std::string_view text(digits.data(), static_cast<std::size_t>(end.ptr - digits.data()));
  const bool is_zero = text.find_first_not_of("-0.") == text.npos;
  text.remove_prefix(is_zero && text.starts_with('-') ? 1 : 0);
  return std::string(text);
}

}  // namespace slamsensor::firmware
