#pragma once

#include "firmware/config/layered_config.hpp"
#include "tools/commands/command.hpp"

#include <tl/expected.hpp>

#include <string>
#include <vector>

namespace slamsensor::tools {

/// The configuration of a verb: defaults < --config FILE < FILE.d/*.toml < --set KEY=VALUE.
struct ConfigOptions {
  std::string file;
  std::vector<std::string> settings;

  /// Adds --config and --set to a verb.
  void add_to(CLI::App& verb);

  /// The same for a configuration that is loaded again and again.
  [[nodiscard]] firmware::ConfigSources sources() const;
};

/// The options laid over `base`, or every mistake in it, one line each (EX_CONFIG).
[[nodiscard]] tl::expected<firmware::LoadedConfig, CommandError> load(const ConfigOptions& options,
                                                                      firmware::LoadedConfig base = {});

}  // namespace slamsensor::tools
