#include "firmware/config/layered_config.hpp"

#include <algorithm>
#include <utility>

namespace slamsensor::firmware {
namespace {

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
  Runtime runtime = runtime_;
  for (const Assignment& one : assignments) {
    const std::string_view section = std::string_view(one.key).substr(0, one.key.find('.'));
    std::erase_if(runtime.assignments, [&](const Assignment& old) { return old.key == one.key; });
    std::erase_if(runtime.absent, [&](const std::string& absent) { return absent == section; });
    runtime.assignments.push_back(one);
  }
  return adopt(base_, refuse_restart_keys(assignments), runtime);
}

LayeredConfig::Result LayeredConfig::unset(std::string_view key) {
  Runtime runtime = runtime_;
  const auto keys = std::erase_if(runtime.assignments, [&](const Assignment& one) { return one.key == key; });
  const auto sections = std::erase_if(
      runtime.absent, [&](const std::string& absent) { return absent == key.substr(0, key.find('.')); });
  if (keys + sections == 0) {
    return tl::unexpected(Errors{control_error(key, "has not been set here; nothing to take back")});
  }
  return adopt(base_, {}, runtime);
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
  Runtime runtime = runtime_;
  std::erase_if(runtime.assignments,
                [&](const Assignment& one) { return one.key.substr(0, one.key.find('.')) == section; });
  runtime.absent.emplace_back(section);
  return adopt(base_, {}, runtime);
}

LayeredConfig::Result LayeredConfig::adopt(const LoadedConfig& base, Errors errors, const Runtime& runtime) {
  LoadedConfig wanted = base;
  for (const std::string& section : runtime.absent) {
    clear_section(wanted, *find_section(section));
  }
  append(errors, apply_assignments(wanted, runtime.assignments, kControl));
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
  wanted_ = std::move(wanted);
  current_ = next;
  runtime_ = runtime;
  return result;
}

}  // namespace slamsensor::firmware
