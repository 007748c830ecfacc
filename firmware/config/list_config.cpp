#include "firmware/config/list_config.hpp"

#include "firmware/config/setting.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <vector>

namespace slamsensor::firmware {
namespace {

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string value_and_unit(const Setting& setting, const Config& config) {
  const std::optional<std::string> value = value_text(setting, config);
  if (!value) {
    return "none";
  }
  return setting.unit.empty() ? *value : *value + ' ' + std::string(setting.unit);
}

/// Who set a value: also "f.toml:3 (point_laser.preset)" for one that the preset brought.
std::string origin_text(std::size_t index, const LoadedConfig& loaded) {
  static const Config kDefaults;
  constexpr std::string_view kPreset = "point_laser.preset";
  const Setting& setting = settings()[index];
  const Origin& origin = loaded.origins[index];
  if (origin.is_default() && setting.section() == "point_laser" &&
      value_text(setting, loaded.config) != value_text(setting, kDefaults)) {
    return loaded.origin(kPreset).short_text() + " (" + std::string(kPreset) + ')';
  }
  return origin.short_text();
}

/// The three or four lines of a key. Without a default the key is a comment too, with nothing behind the
/// equals sign.
std::string commented_key(const Setting& setting, const Config& defaults) {
  const std::optional<std::string> value = value_text(setting, defaults);
  const std::string assignment = std::string(setting.key()) + " =";
  return "\n# " + std::string(setting.description) + "\n# Allowed: " + allowed_text(setting) +
         (setting.apply == Apply::Live ? " (live)\n" : "\n") +
         (value ? assignment + ' ' + *value : "# " + assignment) + '\n';
}

constexpr std::string_view kBitsMark = "# bits: ";
constexpr double kRounding = 1e-14;  // some units in the last place

/// Where a real number is stored; null for other settings and absent sections.
const double* real_of(const Setting& setting, const Config& config) {
  const auto* const real = std::get_if<RealSetting>(&setting.kind);
  return real != nullptr ? real->member.read(config) : nullptr;
}

/// "# bits: PATH HEX" for each real number that `toml` does not give again.
std::string bits_of(const Config& config, const std::string& toml) {
  LoadedConfig read;
  static_cast<void>(apply_layer(read, toml, "settings"));
  std::string lines;
  for (const Setting& setting : settings()) {
    const double* const wanted = real_of(setting, config);
    const double* const got = real_of(setting, read.config);
    if (wanted == nullptr || got == nullptr || *wanted == *got) {
      continue;
    }
    char hex[17] = {};
    std::to_chars(hex, hex + 16, std::bit_cast<std::uint64_t>(*wanted), 16);
    lines.append(kBitsMark).append(setting.path).append(" ").append(hex).append("\n");
  }
  return lines;
}

/// Sets the number that a line names, if it is the one that is there but for rounding.
void apply_bits(Config& config, std::string_view line) {
  const std::size_t space = line.find(' ');
  const auto index = find_setting(line.substr(0, space));
  if (space == std::string_view::npos || !index) {
    return;
  }
  const auto* const real = std::get_if<RealSetting>(&settings()[*index].kind);
  const double* const value = real != nullptr ? real->member.read(config) : nullptr;
  std::uint64_t bits = 0;
  const auto [end, error] = std::from_chars(line.data() + space + 1, line.data() + line.size(), bits, 16);
  if (value == nullptr || error != std::errc() || end != line.data() + line.size()) {
    return;
  }
  const auto exact = std::bit_cast<double>(bits);
  if (std::abs(exact - *value) <= kRounding * std::abs(*value)) {
    *real->member.write(config) = exact;
  }
}

}  // namespace

std::string list_config(const LoadedConfig& loaded) {
  std::vector<std::string> values;
  std::size_t path_width = 0;
  std::size_t value_width = 0;
  for (const Setting& setting : settings()) {
    values.push_back(value_and_unit(setting, loaded.config));
    path_width = std::max(path_width, setting.path.size());
    value_width = std::max(value_width, values.back().size());
  }
  std::string lines;
  for (std::size_t i = 0; i < values.size(); ++i) {
    lines += padded(std::string(settings()[i].path), path_width) + " = " + padded(values[i], value_width) +
             "   " + origin_text(i, loaded) + '\n';
  }
  return lines;
}

std::string default_config_text() {
  const Config defaults;
  std::string text =
      "# slamsensor: every setting, its allowed values and its default. Generated from the program's own "
      "table of\n"
      "# settings. A file of your own needs only the lines that differ. A key marked \"live\" can change "
      "while the\n# sensor runs (reload, or 'slamsensor ctl config set'); the others need a restart.\n";
  for (const Section& section : sections()) {
    text += "\n# " + std::string(section.description) + '\n';
    if (section.is_optional()) {
      text +=
          "# Absent by default: remove the # before the section and all of its keys, and fill in the "
          "values.\n";
    }
    text += (section.is_optional() ? "# [" : "[") + std::string(section.name) + "]\n";
    for (const Setting& setting : settings()) {
      if (setting.section() == section.name) {
        text += commented_key(setting, defaults);
      }
    }
  }
  return text;
}

std::string config_toml(const Config& config) {
  std::string toml;
  for (const Setting& setting : settings()) {
    if (const auto value = value_text(setting, config)) {
      toml.append(setting.path).append(" = ").append(*value).append("\n");
    }
  }
  return toml + bits_of(config, toml);
}

std::vector<ConfigError> apply_config_toml(LoadedConfig& onto, std::string_view toml, std::string_view name) {
  std::vector<ConfigError> errors = apply_layer(onto, toml, name);
  while (!toml.empty()) {
    const std::string_view line = toml.substr(0, toml.find('\n'));
    toml.remove_prefix(std::min(line.size() + 1, toml.size()));
    if (line.starts_with(kBitsMark)) {
      apply_bits(onto.config, line.substr(kBitsMark.size()));
    }
  }
  return errors;
}

}  // namespace slamsensor::firmware
