#include "firmware/config/config_change.hpp"

namespace slamsensor::firmware {
namespace {

std::string shown(const Setting& setting, const Config& config) {
  return value_text(setting, config).value_or("none");
}

}  // namespace

std::string ConfigChange::text() const {
  return std::string(setting().path) + ' ' + before + " -> " + after + " (" + origin.short_text() + ')' +
         (is_live() ? "" : ": needs a restart");
}

std::vector<ConfigChange> changes(const LoadedConfig& before, const LoadedConfig& after) {
  std::vector<ConfigChange> all;
  for (std::size_t i = 0; i < settings().size(); ++i) {
    std::string was = shown(settings()[i], before.config);
    std::string is = shown(settings()[i], after.config);
    if (was != is) {
      all.push_back({i, std::move(was), std::move(is), after.origins[i]});
    }
  }
  return all;
}

LoadedConfig with_live_changes(const LoadedConfig& running, const LoadedConfig& wanted) {
  LoadedConfig mixed = running;
  for (std::size_t i = 0; i < settings().size(); ++i) {
    const Setting& setting = settings()[i];
    if (setting.apply != Apply::Live) {
      continue;
    }
    mixed.origins[i] = wanted.origins[i];
    if (value_text(setting, wanted.config)) {
      copy_setting(setting, wanted.config, mixed.config);
    } else if (const Section* const section = find_section(setting.section()); section->is_optional()) {
      section->clear(mixed.config);
    }
  }
  return mixed;
}

}  // namespace slamsensor::firmware
