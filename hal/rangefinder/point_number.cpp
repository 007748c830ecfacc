#include "hal/rangefinder/point_record.hpp"

namespace slamsensor::hal {
namespace {

constexpr unsigned kDigitsMax = 12;
constexpr std::int64_t kNumberMax = 1'000'000'000'000'000;  // whole and fraction share one number
constexpr unsigned kHexDigitsMax = 8;

bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

/// Takes the digits at the front of `text` into `number`; how many.
unsigned take_digits(std::string_view& text, std::int64_t& number) noexcept {
  unsigned count = 0;
  while (!text.empty() && is_digit(text.front()) && count <= kDigitsMax && number < kNumberMax) {
    number = number * 10 + (text.front() - '0');
    text.remove_prefix(1);
    ++count;
  }
  return count;
}

int hex_value(char c) noexcept {
  if (is_digit(c)) {
    return c - '0';
  }
  if (c >= 'A' && c <= 'F') {
    return c - 'A' + 10;
  }
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

}  // namespace

bool read_decimal(std::string_view text, char separator, AsciiNumber& into) noexcept {
  into = {};
  while (!text.empty() && text.front() == ' ') {
    text.remove_prefix(1);
  }
  const bool is_negative = !text.empty() && text.front() == '-';
  if (is_negative || (!text.empty() && text.front() == '+')) {
    text.remove_prefix(1);
  }
  const unsigned whole = take_digits(text, into.number);
  if (whole == 0 || whole > kDigitsMax) {
    return false;
  }
  if (!text.empty() && text.front() == '.') {
    text.remove_prefix(1);
    into.has_point = true;
    into.decimals = take_digits(text, into.number);
    if (into.decimals == 0 || whole + into.decimals > kDigitsMax) {
      return false;
    }
  }
  if (is_negative) {
    into.number = -into.number;
  }
  if (separator != '\0' && !text.empty() && text.front() == separator) {
    text.remove_prefix(1);
    into.has_strength = true;
    const unsigned digits = take_digits(text, into.strength);
    if (digits == 0 || digits > kDigitsMax) {
      return false;
    }
  }
  return text.empty();
}

bool read_hex(std::string_view text, AsciiNumber& into) noexcept {
  into = {};
  if (text.empty() || text.size() > kHexDigitsMax) {
    return false;
  }
  for (const char c : text) {
    const int value = hex_value(c);
    if (value < 0) {
      return false;
    }
    into.number = into.number * 16 + value;
  }
  return true;
}

}  // namespace slamsensor::hal
