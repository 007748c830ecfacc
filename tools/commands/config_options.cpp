#include "tools/commands/config_options.hpp"

#include <CLI/CLI.hpp>

namespace slamsensor::tools {
namespace {

/// "a.b=c" as TOML: a value that is no TOML value by itself is a bare word and meant as text.
std::string as_toml(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  const std::string value = equals == std::string::npos ? "" : setting.substr(equals + 1);
  const bool bare_word =
      !value.empty() && value != "true" && value != "false" && value != "inf" && value != "nan" &&
      value.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_") == std::string::npos;
  return bare_word ? setting.substr(0, equals + 1) + '"' + value + '"' : setting;
}

}  // namespace

void ConfigOptions::add_to(CLI::App& verb) {
  verb.add_option("-c,--config", file, "configuration file (TOML); see config/")->type_name("FILE");
  verb.add_option("--set", settings,
                  "one setting on top of the file, for example association.tolerance_m=0.75")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

tl::expected<firmware::LoadedConfig, CommandError> load(const ConfigOptions& options) {
  firmware::LoadedConfig loaded;
  std::vector<firmware::ConfigError> errors;
  if (!options.file.empty()) {
    auto from_file = firmware::load_config(options.file);
    if (from_file) {
      loaded = std::move(*from_file);
    } else {
      errors = std::move(from_file.error());
    }
  }
  for (const std::string& setting : options.settings) {
    for (firmware::ConfigError& error : firmware::apply_layer(loaded, as_toml(setting), "--set")) {
      errors.push_back(std::move(error));
    }
  }
  if (errors.empty()) {
    errors = firmware::check_config(loaded);
  }
  if (!errors.empty()) {
    return tl::unexpected(CommandError{firmware::error_lines(errors), EX_CONFIG});
  }
  return loaded;
}

}  // namespace slamsensor::tools
