#include "tools/commands/command.hpp"
#include "tools/commands/config_options.hpp"
#include "tools/commands/progress_bar.hpp"
#include "tools/eval/evaluation_report.hpp"
#include "tools/input/tum.hpp"
#include "tools/output/trajectory_tum.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/replay_report.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

namespace slamsensor::tools {
namespace {

struct Options {
  ConfigOptions config;
  std::string truth;
  std::string out;
  std::vector<std::filesystem::path> inputs;
  bool no_times = false;
};

tl::expected<std::vector<TimedPose>, CommandError> read_truth(const std::string& path) {
  if (path.empty()) {
    return std::vector<TimedPose>{};
  }
  return read_tum(path).map_error([](const InputError& e) {
    return CommandError{e.message + '\n', EX_DATAERR};
  });
}

/// Exit status EX_DATAERR when a scan was refused, after everything that could be done is done.
CommandResult run(const Options& options) {
  const auto loaded = load(options.config);
  if (!loaded) {
    return tl::unexpected(loaded.error());
  }
  const auto truth = read_truth(options.truth);
  if (!truth) {
    return tl::unexpected(truth.error());
  }
  tl::expected<Replay, InputError> result;
  {
    ProgressBar bar("replay");
    result = replay(options.inputs, loaded->config,
                    [&](std::size_t done, std::size_t total, const FixRow&) { bar.update(done, total); });
  }
  if (!result) {
    return tl::unexpected(CommandError{result.error().message + '\n', EX_NOINPUT});
  }
  std::optional<Evaluation> evaluation;
  if (!truth->empty()) {
    auto compared = evaluate(*truth, trajectory_of(result->rows));
    if (!compared) {
      return tl::unexpected(CommandError{options.truth + ": " + compared.error().message + '\n', EX_DATAERR});
    }
    evaluation = std::move(*compared);
  }
  const auto written =
      write_replay(*result, loaded->config, *truth, evaluation,
                   options.no_times ? MeasuredTimes::Empty : MeasuredTimes::Written, options.out);
  if (!written) {
    return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
  }
  for (const std::string& message : result->refused) {
    std::fprintf(stderr, "slamsensor: refused: %s\n", message.c_str());
  }
  std::fputs(replay_summary(*result).c_str(), stdout);
  if (evaluation) {
    std::fputs(evaluation_text(*evaluation).c_str(), stdout);
  }
  std::printf("written to %s: trajectory.tum fixes.csv map.csv track.nmea plot.svg\n", options.out.c_str());
  return result->refused.empty() ? EX_OK : EX_DATAERR;
}

}  // namespace

void add_replay(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("replay", "localise recorded scans: point clouds, readings or landmark lists");
  options->config.add_to(*verb);
  verb->add_option("--truth", options->truth,
                   "true poses to compare with (TUM: t x y z qx qy qz qw, t = scan number)")
      ->type_name("T.tum");
  verb->add_option("--out", options->out, "folder for the results")->required()->type_name("DIR");
  verb->add_flag("--no-times", options->no_times, "leave the measured milliseconds out of fixes.csv");
  verb->add_option("INPUT", options->inputs, "folders or files: .pcd clouds, readings .csv, landmarks .csv")
      ->required();
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
