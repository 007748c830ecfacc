#include "tools/commands/config_options.hpp"

#include <CLI/CLI.hpp>

#include <utility>

namespace slamsensor::tools {

void ConfigOptions::add_to(CLI::App& verb) {
  verb.add_option("-c,--config", file, "configuration file (TOML); see config/")->type_name("FILE");
  verb.add_option("--set", settings,
                  "one setting on top of the file, for example association.tolerance_m=0.75")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

firmware::ConfigSources ConfigOptions::sources() const {
  firmware::ConfigSources sources{.file = file};
  for (const std::string& setting : settings) {
    if (auto assignment = firmware::parse_assignment(setting)) {
      sources.settings.push_back(std::move(*assignment));
    } else {
      sources.mistakes.push_back({{"--set", 0, 0}, firmware::printable(setting), assignment.error()});
    }
  }
  return sources;
}

tl::expected<firmware::LoadedConfig, CommandError> load(const ConfigOptions& options,
                                                        firmware::LoadedConfig base) {
  return firmware::load_layers(options.sources(), std::move(base))
      .map_error([](const std::vector<firmware::ConfigError>& errors) {
        return CommandError{firmware::error_lines(errors), EX_CONFIG};
      });
}

}  // namespace slamsensor::tools
