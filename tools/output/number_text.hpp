#pragma once

#include <charconv>
#include <concepts>
#include <string>

namespace slamsensor::tools {

/// `value` with exactly `decimals` digits (0..17) after the point is appended, whatever the locale; a value
/// that rounds to zero carries no sign.
void append_fixed(std::string& out, double value, int decimals);

/// The shortest decimal text that reads back as `value` is appended, never with an exponent: 7 is "7".
void append_shortest(std::string& out, double value);

/// `value` with at most `digits` significant digits (1..17) is appended, with an exponent where that is
/// shorter.
void append_general(std::string& out, double value, int digits);

/// `value` is appended in decimal.
template <std::integral T>
void append_integer(std::string& out, T value) {
  char text[24];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

/// As `append_fixed`, to a string of its own.
[[nodiscard]] std::string fixed_text(double value, int decimals);

}  // namespace slamsensor::tools
