#include "firmware/config/assignment.hpp"

#include <algorithm>
#include <type_traits>
#include <variant>

namespace slamsensor::firmware {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

bool is_quoted(std::string_view value) {
  return value.starts_with('"') || value.starts_with('\'');
}

std::string text_value(std::string_view value) {
  return is_quoted(value) ? std::string(value) : quoted_text(value);
}

/// "RMC, GGA" as ["RMC", "GGA"].
std::string text_list_value(std::string_view value) {
  if (value.starts_with('[')) {
    return std::string(value);
  }
  std::string list = "[";
  while (!trimmed(value).empty()) {
    const std::size_t comma = std::min(value.find(','), value.size());
    list += (list.size() == 1 ? "" : ", ") + text_value(trimmed(value.substr(0, comma)));
    value.remove_prefix(std::min(comma + 1, value.size()));
  }
  return list + ']';
}

/// A word by which nothing but a text can be meant.
bool is_bare_word(std::string_view value) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
  return !value.empty() && value != "true" && value != "false" && value != "inf" && value != "nan" &&
         value.find_first_not_of(kLetters) == std::string_view::npos;
}

/// The value as TOML writes it for the kind of `setting`.
std::string toml_value(const Setting& setting, std::string_view value) {
  return std::visit(
      [&](const auto& kind) -> std::string {
        using Kind = std::remove_cvref_t<decltype(kind)>;
        if constexpr (std::is_same_v<Kind, TextListSetting>) {
          return text_list_value(value);
        } else if constexpr (std::is_same_v<Kind, IntegerListSetting>) {
          return value.starts_with('[') ? std::string(value) : '[' + std::string(value) + ']';
        } else if constexpr (std::is_same_v<Kind, FreeTextSetting>) {
          return text_value(value);
        } else {
          return is_bare_word(value) ? quoted_text(value) : std::string(value);
        }
      },
      setting.kind);
}

/// What keeps the assignment from being one line of TOML, or nothing.
std::string_view line_fault(const Assignment& assignment) {
  constexpr std::string_view kKeyCharacters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
  if (assignment.key.empty() || assignment.key.find_first_not_of(kKeyCharacters) != std::string::npos) {
    return "is no key; a key is written as section.key";
  }
  if (assignment.value.find_first_of("\r\n") != std::string::npos) {
    return "has a value of more than one line; write line ends as \\n in quotes";
  }
  return {};
}

/// Makes the places in the layer `name` such as have no lines.
void forget_lines(LoadedConfig& loaded, std::vector<ConfigError>& errors, std::string_view name) {
  for (Origin& origin : loaded.origins) {
    if (origin.file == name) {
      origin.line = origin.column = 0;
    }
  }
  for (ConfigError& error : errors) {
    error.place.line = error.place.column = 0;
  }
}

}  // namespace

tl::expected<Assignment, std::string> parse_assignment(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || trimmed(text.substr(0, equals)).empty()) {
    return tl::unexpected<std::string>("no key and value; write KEY=VALUE, for example nmea.rate_hz=5");
  }
  return Assignment{std::string(trimmed(text.substr(0, equals))),
                    std::string(trimmed(text.substr(equals + 1)))};
}

std::vector<ConfigError> apply_assignments(LoadedConfig& onto, const std::vector<Assignment>& assignments,
                                           std::string_view name) {
  std::vector<ConfigError> errors;
  std::string document;
  for (auto one = assignments.begin(); one != assignments.end(); ++one) {
    if (std::any_of(one + 1, assignments.end(), [&](const Assignment& a) { return a.key == one->key; })) {
      continue;
    }
    if (const std::string_view fault = line_fault(*one); !fault.empty()) {
      errors.push_back({{std::string(name), 0, 0}, printable(one->key), std::string(fault)});
      continue;
    }
    const std::optional<std::size_t> index = find_setting(one->key);
    const std::string line = one->key + " = " +
                             (index ? toml_value(settings()[*index], one->value) : text_value(one->value)) +
                             '\n';
    // Alone first: one that is no TOML must not hide the others.
    if (const std::string fault = syntax_fault(line); !fault.empty()) {
      errors.push_back({{std::string(name), 0, 0},
                        one->key,
                        "value " + printable(one->value) + " is not TOML: " + fault +
                            (index ? "; allowed: " + allowed_text(settings()[*index]) : "")});
    } else {
      document += line;
    }
  }
  append(errors, apply_layer(onto, document, name));
  forget_lines(onto, errors, name);
  return errors;
}

}  // namespace slamsensor::firmware
