#include "firmware/config/setting.hpp"

#include <algorithm>
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

/// The decimal next to `exact` with the fewest digits that `reads_back`. Where none does, `exact`.
template <typename ReadsBack>
double shortest(double exact, const ReadsBack& reads_back) {
  for (int digits = 1; digits <= 17; ++digits) {
    const double candidate = rounded(exact, digits);
    if (reads_back(candidate)) {
      return candidate;
    }
  }
  return exact;
}

double written_value(double stored, double scale) {
  return shortest(stored / scale, [&](double value) { return value * scale == stored; });
}

double written_seconds(hal::Stamp stored) {
  return shortest(hal::to_seconds(stored), [&](double value) { return hal::from_seconds(value) == stored; });
}

std::string integer_text(const IntegerSetting& setting, std::int64_t value) {
  if (setting.base == NumberBase::Decimal || value < 0) {
    return std::to_string(value);
  }
  std::array<char, 24> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, 16);
  std::transform(digits.data(), end.ptr, digits.data(),
                 [](char c) { return c >= 'a' ? static_cast<char>(c - 'a' + 'A') : c; });
  return "0x" + std::string(digits.data(), end.ptr);
}

template <typename Items, typename Text>
std::string list_text(const Items& items, const Text& text) {
  std::string list = "[";
  for (const auto& item : items) {
    list += (list.size() == 1 ? "" : ", ") + text(item);
  }
  return list + ']';
}

std::string count_text(const ItemCount& items) {
  return items.min == items.max ? std::to_string(items.min)
                                : std::to_string(items.min) + " to " + std::to_string(items.max);
}

std::string with_unit(std::string text, std::string_view unit) {
  return unit.empty() ? text : text + ' ' + std::string(unit);
}

std::string alternatives(std::span<const std::string_view> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + quoted_text(names[i]);
  }
  return text;
}

struct ValueText {
  const Config& config;
  using Value = std::optional<std::string>;

  Value operator()(const RealSetting& s) const {
    const double* const value = s.member.read(config);
    return value == nullptr ? Value() : real_text(written_value(*value, s.scale));
  }
  Value operator()(const DurationSetting& s) const {
    const hal::Stamp* const value = s.member.read(config);
    return value == nullptr ? Value() : real_text(written_seconds(*value));
  }
  Value operator()(const IntegerSetting& s) const {
    const std::optional<std::int64_t> value = s.access.read(config);
    return value ? integer_text(s, *value) : Value();
  }
  Value operator()(const BooleanSetting& s) const {
    const bool* const value = s.member.read(config);
    return value == nullptr ? Value() : *value ? "true" : "false";
  }
  Value operator()(const ChoiceSetting& s) const {
    const std::optional<std::size_t> choice = s.access.read(config);
    return choice && *choice < s.names.size() ? quoted_text(s.names[*choice]) : Value();
  }
  Value operator()(const TextSetting& s) const {
    const std::string* const value = s.member.read(config);
    return value == nullptr ? Value() : quoted_text(*value);
  }
  Value operator()(const FreeTextSetting& s) const {
    const std::optional<std::string> value = s.access.read(config);
    return value ? quoted_text(*value) : Value();
  }
  Value operator()(const IntegerListSetting& s) const {
    const auto* const values = s.member.read(config);
    return values == nullptr ? Value()
                             : list_text(*values, [](std::uint32_t value) { return std::to_string(value); });
  }
  Value operator()(const TextListSetting& s) const {
    const auto values = s.access.read(config);
    return values ? list_text(*values, quoted_text) : Value();
  }
};

struct AllowedText {
  std::string_view unit;

  std::string operator()(const RealSetting& s) const {
    return with_unit(real_text(s.min) + " .. " + real_text(s.max), unit);
  }
  std::string operator()(const DurationSetting& s) const {
    return with_unit(real_text(s.min_s) + " .. " + real_text(s.max_s), unit);
  }
  std::string operator()(const IntegerSetting& s) const {
    std::string text;
    for (std::size_t i = 0; i < s.only.size(); ++i) {
      text += (i == 0 ? "" : i + 1 == s.only.size() ? " or " : ", ") + std::to_string(s.only[i]);
    }
    return with_unit(text.empty() ? integer_text(s, s.min) + " .. " + integer_text(s, s.max) : text, unit);
  }
  std::string operator()(const BooleanSetting&) const { return "true or false"; }
  std::string operator()(const ChoiceSetting& s) const { return alternatives(s.names); }
  std::string operator()(const TextSetting& s) const { return alternatives(s.names); }
  std::string operator()(const FreeTextSetting& s) const { return std::string(s.rule->words); }
  std::string operator()(const IntegerListSetting& s) const {
    return "a list of " + count_text(s.items) + " out of " +
           with_unit(std::to_string(s.min) + " .. " + std::to_string(s.max), unit);
  }
  std::string operator()(const TextListSetting& s) const {
    return "a list of " + count_text(s.items) + ", each " + std::string(s.rule->words);
  }
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

std::string quoted_text(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (c == '\r' || c == '\n' || c == '\t') {
      quoted += {'\\', c == '\r' ? 'r' : c == '\n' ? 'n' : 't'};
    } else if (code < 0x20 || code == 0x7F) {
      quoted += {'\\', 'u', '0', '0', kDigits[code >> 4U], kDigits[code & 15U]};
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::optional<std::string> value_text(const Setting& setting, const Config& config) {
  return std::visit(ValueText{config}, setting.kind);
}

std::string allowed_text(const Setting& setting) {
  return std::visit(AllowedText{setting.unit}, setting.kind);
}

}  // namespace slamsensor::firmware
