#include "firmware/status/sensor_status.hpp"
#include "tools/commands/command.hpp"
#include "tools/report/figure_command.hpp"
#include "tools/report/report_command.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <string>

namespace {

int run(int argc, char** argv) {
  using namespace slamsensor::tools;  // NOLINT(google-build-using-namespace): the verbs of this program
  CLI::App app(
      "slamsensor: a standalone SLAM sensor. One verb per job, the same on a sensor and on a recording.");
  app.require_subcommand(1);
  app.set_version_flag("--version", "slamsensor " + std::string(slamsensor::firmware::kVersion));
  CommandResult result = EX_OK;
  add_replay(app, result);
  add_locate(app, result);
  add_eval(app, result);
  add_report(app, result);
  add_figure(app, result);
  add_simulate(app, result);
  add_demo(app, result);
  add_emulate(app, result);
  add_record(app, result);
  add_top(app, result);
  add_view(app, result);
  add_map(app, result);
  add_ctl(app, result);
  add_edges(app, result);
  add_memory(app, result);
  add_check_config(app, result);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool is_unknown_verb = argc > 1 && argv[1][0] != '-' && app.get_subcommands().empty();
    if (is_unknown_verb) {
      std::fprintf(stderr, "slamsensor: '%s' is no verb; slamsensor --help lists them\n", argv[1]);
      return EX_USAGE;
    }
    const int status = app.exit(error);
    return status == 0 ? EX_OK : EX_USAGE;
  }
  if (!result) {
    std::fprintf(stderr, "slamsensor: %s", result.error().message.c_str());
    return result.error().exit_status;
  }
  return std::fflush(stdout) == 0 ? *result : EX_IOERR;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slamsensor: %s; this is a fault of the program, please report it\n", error.what());
    return EX_SOFTWARE;
  }
}
