#include "firmware/config/list_config.hpp"

#include <algorithm>
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

}  // namespace slamsensor::firmware
