#include "firmware/config/setting.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace slamsensor::firmware {
namespace {

/// `value` rounded to `digits` significant decimal digits.
double rounded(double value, int digits) {
  std::array<char, 64> buffer{};
  char* const begin = buffer.data();
  const auto end =
      std::to_chars(begin, begin + buffer.size(), value, std::chars_format::scientific, digits - 1);
  double result = 0.0;
  std::from_chars(begin, end.ptr, result);
  return result;
}

/// The decimal with the fewest digits that becomes `stored` when it is multiplied by `scale`. Where none
/// does, the nearest.
double written_value(double stored, double scale) {
  const double exact = stored / scale;
  for (int digits = 1; digits <= 17; ++digits) {
    const double candidate = rounded(exact, digits);
    if (candidate * scale == stored) {
      return candidate;
    }
  }
  return exact;
}

std::string quoted(std::string_view text) {
  return '"' + std::string(text) + '"';
}

std::string with_unit(std::string text, std::string_view unit) {
  return unit.empty() ? text : text + ' ' + std::string(unit);
}

std::string alternatives(std::span<const std::string_view> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + quoted(names[i]);
  }
  return text;
}

struct ValueText {
  const Config& config;

  std::optional<std::string> operator()(const RealSetting& s) const {
    const double* const value = s.member.read(config);
    return value == nullptr ? std::nullopt : std::optional(real_text(written_value(*value, s.scale)));
  }
  std::optional<std::string> operator()(const IntegerSetting& s) const {
    const std::uint32_t* const value = s.member.read(config);
    return value == nullptr ? std::nullopt : std::optional(std::to_string(*value));
  }
  std::optional<std::string> operator()(const BooleanSetting& s) const {
    const bool* const value = s.member.read(config);
    return value == nullptr ? std::nullopt : std::optional<std::string>(*value ? "true" : "false");
  }
  std::optional<std::string> operator()(const TextSetting& s) const {
    const std::string* const value = s.member.read(config);
    return value == nullptr ? std::nullopt : std::optional(quoted(*value));
  }
  std::optional<std::string> operator()(const ChoiceSetting& s) const {
    const std::size_t choice = s.read(config);
    return choice < s.names.size() ? std::optional(quoted(s.names[choice])) : std::nullopt;
  }
};

struct AllowedText {
  std::string_view unit;

  std::string operator()(const RealSetting& s) const {
    return with_unit(real_text(s.min) + " .. " + real_text(s.max), unit);
  }
  std::string operator()(const IntegerSetting& s) const {
    return with_unit(std::to_string(s.min) + " .. " + std::to_string(s.max), unit);
  }
  std::string operator()(const BooleanSetting&) const { return "true or false"; }
  std::string operator()(const TextSetting& s) const { return alternatives(s.names); }
  std::string operator()(const ChoiceSetting& s) const { return alternatives(s.names); }
};

}  // namespace

std::string real_text(double value) {
  const double magnitude = std::abs(value);
  const bool plain = magnitude == 0.0 || (magnitude >= 1e-5 && magnitude < 1e15);
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 plain ? std::chars_format::fixed : std::chars_format::scientific);
  std::string text(buffer.data(), end.ptr);
  if (text.find_first_of(".en") == std::string::npos) {
    text += ".0";
  }
  return text;
}

std::optional<std::string> value_text(const Setting& setting, const Config& config) {
  return std::visit(ValueText{config}, setting.kind);
}

std::string allowed_text(const Setting& setting) {
  return std::visit(AllowedText{setting.unit}, setting.kind);
}

}  // namespace slamsensor::firmware
