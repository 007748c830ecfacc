#include "firmware/config/daemon_config.hpp"
#include "tools/commands/command.hpp"
#include "tools/map_files/map_verbs.hpp"
#include "tools/map_files/open_map.hpp"
#include "tools/output/result_files.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace slamsensor::tools {
namespace {

struct Options {
  std::string map;
  std::filesystem::path store = firmware::MapStoreConfig().directory;
  std::filesystem::path csv;
};

CommandResult run(const Options& options) {
  if (options.map.empty()) {
    return tl::unexpected(CommandError{
        "map: name a map file or a map of the store, or say export or import; slamsensor map --help\n",
        EX_USAGE});
  }
  const auto opened = open_map(options.map, options.store);
  if (!opened) {
    return tl::unexpected(CommandError{opened.error() + '\n', EX_DATAERR});
  }
  std::fputs(map_info_text(opened->map, opened->bytes).c_str(), stdout);
  if (!options.csv.empty()) {
    if (const auto written = write_map(options.csv, map_rows(opened->map)); !written) {
      return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
    }
  }
  return EX_OK;
}

}  // namespace

void add_map(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("map", "what a map holds; a map for other programs, a survey as a map");
  verb->add_option("MAP", options->map, "a map file NAME.slammap, or the name of a map of the store");
  verb->add_option("--store", options->store, "the folder of the sensor's maps (map.directory)")
      ->type_name("FOLDER")
      ->capture_default_str();
  verb->add_option("--csv", options->csv, "write its landmarks for locate --map: id,x_m,y_m,...")
      ->type_name("map.csv");
  verb->require_subcommand(0, 1);
  add_map_export(*verb, result);
  add_map_import(*verb, result);
  verb->callback([verb, options, &result] {
    if (verb->get_subcommands().empty()) {
      result = run(*options);
    }
  });
}

}  // namespace slamsensor::tools
