#include "firmware/supervision/plain_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace slamsensor::firmware {
namespace {

std::uint8_t byte_at(std::string_view text, std::size_t i) noexcept {
  return static_cast<std::uint8_t>(text[i]);
}

/// Bytes of the UTF-8 character that `text` begins with; 0 when it begins with none (overlong forms,
/// surrogates and numbers beyond Unicode are none).
std::size_t character_size(std::string_view text) noexcept {
  const std::uint8_t lead = byte_at(text, 0);
  const std::size_t size = lead < 0x80   ? 1
                           : lead < 0xC2 ? 0
                           : lead < 0xE0 ? 2
                           : lead < 0xF0 ? 3
                           : lead < 0xF5 ? 4
                                         : 0;
  if (size == 0 || size > text.size()) {
    return 0;
  }
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte_at(text, i) & 0xC0U) != 0x80U) {
      return 0;
    }
  }
  const std::uint8_t second = size > 1 ? byte_at(text, 1) : 0;
  const bool is_impossible = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
                             (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F);
  return is_impossible ? 0 : size;
}

}  // namespace

std::string plain_text(std::string_view text) {
  std::string plain;
  plain.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    if (size == 0 || is_control(text.front())) {
      plain += '?';
    } else {
      plain.append(text.substr(0, size));
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return plain;
}

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
