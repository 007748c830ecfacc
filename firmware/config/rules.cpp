#include "firmware/config/rules.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

/// Also in one that belongs to it: canopen and canopen_pan.
bool is_in_section(const ConfigError& error, std::string_view section) {
  return error.key.starts_with(section);
}

}  // namespace

void Rules::require(bool holds, std::initializer_list<std::string_view> keys, const std::string& what) {
  if (holds || std::any_of(keys.begin(), keys.end(), [&](std::string_view key) { return is_known(key); })) {
    return;
  }
  Origin place;
  std::string others;
  for (const std::string_view key : keys) {
    const Origin& origin = loaded_.origin(key);
    place = place.is_default() ? origin : place;
    if (key != *keys.begin()) {
      others += (others.empty() ? " " : ", ") + std::string(key) + " = " + value(key) + " (" +
                origin.short_text() + ')';
    }
  }
  const std::string_view first = *keys.begin();
  errors_.push_back({place, std::string(first),
                     "value " + value(first) + ' ' + what + others +
                         (keys.size() == 1 ? "; change it" : "; change one of them")});
}

void Rules::refuse_section(std::string_view section, const std::string& what) {
  const auto is_here = [&](const ConfigError& error) { return is_in_section(error, section); };
  if (std::any_of(known_.begin(), known_.end(), is_here) ||
      std::any_of(errors_.begin(), errors_.end(), is_here)) {
    return;
  }
  std::string_view at = section;
  Origin place = loaded_.origin(section);  // a driver may name a key instead
  for (const Setting& setting : settings()) {
    const bool is_named = setting.section() == section && what.find(setting.key()) != std::string::npos;
    const Origin& origin = loaded_.origin(setting.path);
    if (is_named && (at == section || !origin.is_default())) {
      at = setting.path;
      place = origin;
    }
  }
  errors_.push_back({place, std::string(at), what});
}

bool Rules::is_known(std::string_view key) const {
  return std::any_of(known_.begin(), known_.end(),
                     [&](const ConfigError& error) { return error.key == key; });
}

std::string Rules::value(std::string_view key) const {
  const Setting& setting = settings()[find_setting(key).value()];
  return value_text(setting, loaded_.config).value_or("none");
}

}  // namespace slamsensor::firmware
