#include "tools/commands/options.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

namespace slamsensor::tools {
namespace {

CommandResult run(DriveOptions& options) {
  return options.run().map([&](const SimulateSummary& summary) {
    std::printf("%u scans of %llu readings, %llu with a return, among %u objects (%u found no room)\n",
                summary.scans,
                static_cast<unsigned long long>(summary.readings / std::max(summary.scans, 1U)),
                static_cast<unsigned long long>(summary.returns / std::max(summary.scans, 1U)),
                summary.objects, summary.unplaced);
    std::printf("written to %s: scan_*.csv truth.tum stems.csv\n", options.simulate.out.c_str());
    return EX_OK;
  });
}

}  // namespace

void add_simulate(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<DriveOptions>();
  CLI::App* verb = app.add_subcommand("simulate", "make scans of a simulated world, with their truth");
  options->add_to(*verb);
  verb->add_option("--out", options->simulate.out, "folder for the scans")->required()->type_name("DIR");
  verb->add_option("WORLD", options->simulate.world, "world file (TOML); see config/worlds")->required();
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
