#include "firmware/store/map_layout.hpp"
#include "firmware/store/store_io.hpp"
#include "tools/commands/command.hpp"
#include "tools/output/result_files.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace slamsensor::tools {
namespace {

struct Options {
  std::filesystem::path file;
  std::filesystem::path csv;
};

CommandResult run(const Options& options) {
  const auto fail = [&](const std::string& message) {
    return tl::unexpected(CommandError{options.file.string() + ": " + message + '\n', EX_DATAERR});
  };
  const auto content = firmware::read_regular(options.file, firmware::kMapFileBytesMax);
  if (!content) {
    return fail(content.error().text());
  }
  const auto map = firmware::decode_map(content->bytes, firmware::unlimited_capacities());
  if (!map) {
    return fail(map.error().message);
  }
  std::fputs(map_info_text(*map, content->bytes.size()).c_str(), stdout);
  if (!options.csv.empty()) {
    if (const auto written = write_map(options.csv, map_rows(*map)); !written) {
      return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
    }
  }
  return EX_OK;
}

}  // namespace

void add_map(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("map", "check a map file and tell what it holds");
  verb->add_option("FILE", options->file, "a map of the daemon's store: NAME.slammap")->required();
  verb->add_option("--csv", options->csv, "write its landmarks for locate --map: id,x_m,y_m,...")
      ->type_name("map.csv");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
