#include "core/slam.hpp"
#include "firmware/config/list_config.hpp"
#include "firmware/store/map_snapshot.hpp"
#include "tools/commands/command.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <string_view>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kMapCopies = 2;  // of the daemon: the SLAM thread's outlet, and what is being sent

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

/// Bytes of the entries whose names begin with one of `beginnings`.
std::size_t bytes_of(const core::Arena::Plan& plan, std::initializer_list<std::string_view> beginnings) {
  std::size_t bytes = 0;
  for (const auto& entry : plan) {
    const std::string_view name = entry.name;
    bytes += std::any_of(beginnings.begin(), beginnings.end(),
                         [&](std::string_view beginning) { return name.starts_with(beginning); })
                 ? entry.bytes
                 : 0;
  }
  return bytes;
}

/// What the same configuration takes with other capacities: a line for each size of the map, with ten
/// sightings and twelve edges for a landmark, and the poses as they are set.
void print_sizes(core::Config config) {
  std::printf("\n%-12s %14s %14s %14s %14s\n", "landmarks", "index B each", "entry B each", "block bytes",
              "copies bytes");
  for (const std::uint32_t landmarks : {10'000U, 100'000U, 1'000'000U}) {
    config.capacities.map_landmarks = landmarks;
    config.capacities.map_edges = 12 * landmarks;
    config.capacities.sightings = 10 * landmarks;
    std::size_t bytes = 0;
    const core::Arena::Plan plan = core::plan_memory(config, bytes);
    const std::size_t index = bytes_of(plan, {"index: "});
    const std::size_t entry =
        bytes_of(plan, {"maps: landmarks", "maps: positions", "maps: standing", "maps: slots", "maps: free"});
    std::printf("%-12u %14.1f %14.1f %14zu %14zu\n", landmarks, static_cast<double>(index) / landmarks,
                static_cast<double>(entry) / landmarks, bytes,
                kMapCopies * firmware::MapSnapshot::bytes(config.capacities));
  }
  std::puts(
      "each: of a landmark, in the index and in the map; copies: of the home map, for those who save and "
      "send it");
}

CommandResult memory(const ConfigOptions& options) {
  return load(options).map([](const firmware::LoadedConfig& loaded) {
    std::size_t bytes = 0;
    const core::Arena::Plan plan = core::plan_memory(loaded.config.core, bytes);
    print_plan(plan, bytes);
    print_sizes(loaded.config.core);
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
