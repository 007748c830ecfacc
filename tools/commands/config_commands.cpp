#include "core/slam.hpp"
#include "firmware/config/list_config.hpp"
#include "tools/commands/command.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <cstdio>
#include <memory>
#include <string_view>

namespace slamsensor::tools {
namespace {

CommandResult check(const ConfigOptions& options, bool print_defaults) {
  if (print_defaults) {
    std::fputs(firmware::default_config_text().c_str(), stdout);
    return EX_OK;
  }
  return load(options).map([](const firmware::LoadedConfig& loaded) {
    std::fputs(firmware::list_config(loaded).c_str(), stdout);
    return EX_OK;
  });
}

/// One line per name in the order of the plan; what several hypotheses take is one line.
void print_plan(const core::Arena::Plan& plan, std::size_t bytes) {
  std::printf("%-36s %12s %14s\n", "memory of core", "objects", "bytes");
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const std::string_view name = plan[i].name;
    std::size_t count = 0;
    std::size_t size = 0;
    bool first = true;
    for (std::size_t j = 0; j < plan.size(); ++j) {
      if (name == plan[j].name) {
        first = first && j >= i;
        count += plan[j].count;
        size += plan[j].bytes;
      }
    }
    if (first) {
      std::printf("%-36.*s %12zu %14zu\n", static_cast<int>(name.size()), name.data(), count, size);
    }
  }
  std::printf("%-36s %12s %14zu\n", "one block, taken before anything starts", "", bytes);
}

CommandResult memory(const ConfigOptions& options) {
  return load(options).map([](const firmware::LoadedConfig& loaded) {
    std::size_t bytes = 0;
    const core::Arena::Plan plan = core::plan_memory(loaded.config.core, bytes);
    print_plan(plan, bytes);
    return EX_OK;
  });
}

}  // namespace

void add_check_config(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<ConfigOptions>();
  auto defaults = std::make_shared<bool>(false);
  CLI::App* verb =
      app.add_subcommand("check-config", "check a configuration; print every value in force and its origin");
  options->add_to(*verb);
  verb->add_option("FILE", options->file, "the same as --config FILE");
  verb->add_flag("--defaults", *defaults, "print the commented default file instead");
  verb->callback([options, defaults, &result] { result = check(*options, *defaults); });
}

void add_memory(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<ConfigOptions>();
  CLI::App* verb = app.add_subcommand("memory", "print the whole memory plan of a configuration, in bytes");
  options->add_to(*verb);
  verb->callback([options, &result] { result = memory(*options); });
}

}  // namespace slamsensor::tools
