#include "tools/output/number_text.hpp"

#include <algorithm>
#include <string_view>

namespace slamsensor::tools {
namespace {

// The longest double has 309 digits before the point; fixed notation of the smallest has 17 + 324 behind it.
constexpr std::size_t kTextMax = 512;

void append_without_negative_zero(std::string& out, std::string_view text) {
  const bool is_zero = text.find_first_not_of("-0.") == std::string_view::npos;
  if (is_zero && !text.empty() && text.front() == '-') text.remove_prefix(1);
  out.append(text);
}

}  // namespace

void append_fixed(std::string& out, double value, int decimals) {
  char text[kTextMax];
  const auto end =
      std::to_chars(text, text + kTextMax, value, std::chars_format::fixed, std::clamp(decimals, 0, 17)).ptr;
  append_without_negative_zero(out, {text, static_cast<std::size_t>(end - text)});
}

void append_shortest(std::string& out, double value) {
  char text[kTextMax];
  const auto end = std::to_chars(text, text + kTextMax, value, std::chars_format::fixed).ptr;
  append_without_negative_zero(out, {text, static_cast<std::size_t>(end - text)});
}

void append_general(std::string& out, double value, int digits) {
  char text[kTextMax];
  const auto end =
      std::to_chars(text, text + kTextMax, value, std::chars_format::general, std::clamp(digits, 1, 17)).ptr;
  append_without_negative_zero(out, {text, static_cast<std::size_t>(end - text)});
}

std::string fixed_text(double value, int decimals) {
  std::string out;
  append_fixed(out, value, decimals);
  return out;
}

}  // namespace slamsensor::tools
