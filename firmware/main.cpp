// The daemon slamsensord: arguments, configuration, and an exit status that says what was wrong (sysexits).
#include "firmware/config/layered_config.hpp"
#include "firmware/daemon/daemon.hpp"
#include "firmware/status/sensor_status.hpp"

#include <cstdio>
#include <getopt.h>
#include <new>
#include <optional>
#include <string>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr const char* kUsage =
    "usage: slamsensord [--config FILE] [--set KEY=VALUE]... [--emulated]\n"
    "  --config FILE    settings; those of FILE.d/*.toml on top (default: the built-in ones)\n"
    "  --set KEY=VALUE  one more setting on top; may be given again\n"
    "  --emulated       the devices are emulated: outputs say so (GGA quality 8, RMC mode S)\n"
    "  --version, --help\n"
    "See 'slamsensor check-config' for the settings and 'slamsensor ctl help' for what can be asked.\n";

struct Arguments {
  ConfigSources sources;
  SourceMode source = SourceMode::Live;
};

/// An exit status when there is nothing to run.
std::optional<int> parse(int argc, char** argv, Arguments& arguments) {
  const option options[] = {
      {"config", required_argument, nullptr, 'c'}, {"set", required_argument, nullptr, 's'},
      {"emulated", no_argument, nullptr, 'e'},     {"version", no_argument, nullptr, 'v'},
      {"help", no_argument, nullptr, 'h'},         {nullptr, 0, nullptr, 0}};
  for (int choice = 0; (choice = getopt_long(argc, argv, "", options, nullptr)) != -1;) {
    if (choice == 'c') {
      arguments.sources.file = optarg;
    } else if (choice == 's') {
      auto assignment = parse_assignment(optarg);
      if (!assignment) {
        std::fprintf(stderr, "slamsensord: --set %s: %s\n", optarg, assignment.error().c_str());
        return exit_status(ExitReason::Usage);
      }
      arguments.sources.settings.push_back(std::move(*assignment));
    } else if (choice == 'e') {
      arguments.source = SourceMode::Emulated;
    } else if (choice == 'v') {
      std::printf("slamsensord %s\n", std::string(kVersion).c_str());
      return 0;
    } else {
      std::fputs(kUsage, choice == 'h' ? stdout : stderr);
      return choice == 'h' ? 0 : exit_status(ExitReason::Usage);
    }
  }
  if (optind < argc) {
    std::fprintf(stderr, "slamsensord: unexpected argument '%s'\n%s", argv[optind], kUsage);
    return exit_status(ExitReason::Usage);
  }
  return std::nullopt;
}

int run(Arguments arguments) {
  Log log({.style = log_style(2)});
  auto config = LayeredConfig::create(std::move(arguments.sources));
  if (!config) {
    log.error(error_lines(config.error()));
    return exit_status(ExitReason::Config);
  }
  for (const ConfigError& warning : config->current().warnings) {
    log.warning(warning.text());
  }
  auto daemon = Daemon::create(std::move(*config), arguments.source, log);
  if (!daemon) {
    log.error(daemon.error().message);
    return exit_status(daemon.error().reason);
  }
  if (auto ran = (*daemon)->run(); !ran) {
    log.error(ran.error().message);
    return exit_status(ran.error().reason);
  }
  return exit_status(ExitReason::Ordered);
}

}  // namespace
}  // namespace slamsensor::firmware

int main(int argc, char** argv) {
  using namespace slamsensor::firmware;
  Arguments arguments;
  try {
    if (const auto status = parse(argc, argv, arguments)) {
      return *status;
    }
    return run(std::move(arguments));
  } catch (const std::bad_alloc&) {
    Log({.style = log_style(2)})
        .error("out of memory; give the service more (MemoryMax=, LimitAS=), or lower [capacities]");
    return exit_status(ExitReason::NoResources);
  }
}
