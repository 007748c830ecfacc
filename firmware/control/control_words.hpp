#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// `text` without blanks at both ends.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) noexcept {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t first = std::min(text.find_first_not_of(kBlanks), text.size());
  const std::size_t last = text.find_last_not_of(kBlanks);
  return last == text.npos ? std::string_view() : text.substr(first, last + 1 - first);
}

/// Takes the first word off `rest`, which keeps no blanks at its ends; empty when there is none.
[[nodiscard]] constexpr std::string_view take_word(std::string_view& rest) noexcept {
  rest = trimmed(rest);
  const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
  rest = trimmed(rest.substr(word.size()));
  return word;
}

/// 'text'
[[nodiscard]] inline std::string quoted(std::string_view text) {
  return '\'' + std::string(text) + '\'';
}

}  // namespace slamsensor::firmware
