#include "firmware/config/layered_config.hpp"

#include <algorithm>
#include <utility>

namespace slamsensor::firmware {
namespace {

std::string shown(const Setting& setting, const Config& config) {
  return value_text(setting, config).value_or("none");
}

constexpr std::string_view kCommandLine = "--set";
constexpr std::string_view kControl = "control socket";

using Errors = LayeredConfig::Errors;

/// Lays all sources over `onto`, and returns their mistakes but those between keys.
Errors apply_sources(LoadedConfig& onto, const ConfigSources& sources) {
  Errors errors;
  if (!sources.file.empty()) {
    errors = apply_files(onto, sources.file);
  }
  append(errors, sources.mistakes);
  append(errors, apply_assignments(onto, sources.settings, kCommandLine));
  return errors;
}

ConfigError control_error(std::string_view key, std::string message) {
  return {{std::string(kControl), 0, 0}, printable(key), std::move(message)};
}

/// Makes `section` absent: its keys are nobody's.
void clear_section(LoadedConfig& loaded, const Section& section) {
  section.clear(loaded.config);
  for (std::size_t i = 0; i < settings().size(); ++i) {
    if (settings()[i].section() == section.name) {
      loaded.origins[i] = {};
    }
  }
}

std::string_view section_of(std::string_view key) {
  return key.substr(0, key.find('.'));
}

/// Lays the runtime layer over `onto`, and returns its mistakes but those between keys.
Errors apply_runtime(LoadedConfig& onto, const std::vector<Assignment>& runtime) {
  std::vector<Assignment> keys;
  for (const Assignment& one : runtime) {
    if (const Section* const absent = find_section(one.key)) {
      clear_section(onto, *absent);
    } else {
      keys.push_back(one);
    }
  }
  return apply_assignments(onto, keys, kControl);
}

/// Keys that need a restart: set in memory they would never come into force.
Errors refuse_restart_keys(const std::vector<Assignment>& assignments) {
  Errors errors;
  for (const Assignment& one : assignments) {
    const std::optional<std::size_t> index = find_setting(one.key);
    if (index && settings()[*index].apply == Apply::Restart) {
      errors.push_back(control_error(one.key, "needs a restart; write it into the file and restart"));
    }
  }
  return errors;
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
  mixed.warnings = wanted.warnings;
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

tl::expected<LoadedConfig, std::vector<ConfigError>> load_layers(const ConfigSources& sources,
                                                                 LoadedConfig base) {
  Errors errors = apply_sources(base, sources);
  append(errors, check_config(base, errors));
  if (!errors.empty()) {
    return tl::unexpected(std::move(errors));
  }
  return base;
}

tl::expected<LayeredConfig, LayeredConfig::Errors> LayeredConfig::create(ConfigSources sources) {
  auto loaded = load_layers(sources);
  if (!loaded) {
    return tl::unexpected(std::move(loaded.error()));
  }
  return LayeredConfig(std::move(sources), std::move(*loaded));
}

LayeredConfig::Result LayeredConfig::reload() {
  LoadedConfig base;
  Errors errors = apply_sources(base, sources_);
  return adopt(base, std::move(errors), runtime_);
}

LayeredConfig::Result LayeredConfig::set(const std::vector<Assignment>& assignments) {
  std::vector<Assignment> runtime = runtime_;
  for (const Assignment& one : assignments) {
    std::erase_if(
        runtime, [&](const Assignment& old) { return old.key == one.key || old.key == section_of(one.key); });
    runtime.push_back(one);
  }
  return adopt(base_, refuse_restart_keys(assignments), std::move(runtime));
}

LayeredConfig::Result LayeredConfig::unset(std::string_view key) {
  std::vector<Assignment> runtime = runtime_;
  const auto is_it = [&](const Assignment& one) { return one.key == key || one.key == section_of(key); };
  if (std::erase_if(runtime, is_it) == 0) {
    return tl::unexpected(Errors{control_error(key, "has not been set here; nothing to take back")});
  }
  return adopt(base_, {}, std::move(runtime));
}

LayeredConfig::Result LayeredConfig::set_absent(std::string_view section) {
  const Section* const found = find_section(section);
  const auto is_live = [&](const Setting& setting) {
    return setting.section() != section || setting.apply == Apply::Live;
  };
  if (found == nullptr || !found->is_optional() ||
      !std::all_of(settings().begin(), settings().end(), is_live)) {
    return tl::unexpected(
        Errors{control_error(section, "is no section that can be taken away from a running sensor")});
  }
  std::vector<Assignment> runtime = runtime_;
  std::erase_if(runtime, [&](const Assignment& one) { return section_of(one.key) == section; });
  runtime.push_back({std::string(section), {}});
  return adopt(base_, {}, std::move(runtime));
}

std::vector<ConfigChange> LayeredConfig::pending() const {
  LoadedConfig wanted = base_;
  static_cast<void>(apply_runtime(wanted, runtime_));  // without mistakes when it was adopted
  return changes(current_, wanted);
}

LayeredConfig::Result LayeredConfig::adopt(const LoadedConfig& base, Errors errors,
                                           std::vector<Assignment> runtime) {
  LoadedConfig wanted = base;
  append(errors, apply_runtime(wanted, runtime));
  append(errors, check_config(wanted, errors));
  if (!errors.empty()) {
    return tl::unexpected(std::move(errors));
  }
  const LoadedConfig next = with_live_changes(current_, wanted);
  // What can change live may not go with what has to stay until a restart.
  if (Errors clash = check_config(next); !clash.empty()) {
    for (ConfigError& error : clash) {
      error.message += " (the value that needs a restart is still in force; restart for both)";
    }
    return tl::unexpected(std::move(clash));
  }
  Reconfiguration result{changes(current_, next), changes(next, wanted)};
  base_ = base;
  current_ = next;
  runtime_ = std::move(runtime);
  return result;
}

}  // namespace slamsensor::firmware
