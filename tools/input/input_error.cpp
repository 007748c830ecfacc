#include "tools/input/input_error.hpp"

#include <array>
#include <charconv>

namespace slamsensor::tools {

tl::unexpected<InputError> refuse(std::string_view name, std::string_view what) {
  std::string message(name);
  message.append(": ").append(what);
  return tl::unexpected<InputError>(InputError{std::move(message)});
}

tl::unexpected<InputError> refuse_line(std::string_view name, std::size_t line, std::string_view what) {
  return refuse(std::string(name) + ":" + std::to_string(line), what);
}

tl::expected<void, InputError> check_encoding(std::string_view start, std::string_view name) {
  constexpr std::size_t kLookedAtBytes = 64;  // UTF-16 without a mark has a zero in each pair of bytes
  const bool has_mark = start.starts_with("\xFF\xFE") || start.starts_with("\xFE\xFF");
  if (has_mark || start.substr(0, kLookedAtBytes).find('\0') != std::string_view::npos) {
    return refuse(name, "is text in UTF-16, or no text; save it as UTF-8");
  }
  return {};
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShownMax = 40;
  std::string result = "'";
  for (const char c : text.substr(0, kShownMax)) {
    result += (c >= ' ' && c <= '~') ? c : '?';
  }
  result += text.size() > kShownMax ? "...'" : "'";
  return result;
}

std::string shown(double value) {
  std::array<char, 32> digits{};
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 6);
  return std::string(digits.data(), end.ptr);
}

}  // namespace slamsensor::tools
