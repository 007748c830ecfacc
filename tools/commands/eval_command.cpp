#include "core/config.hpp"
#include "tools/commands/command.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/input/text.hpp"
#include "tools/input/text_files.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

namespace slamsensor::tools {
namespace {

struct Options {
  std::string truth;
  std::string trajectory;
  bool json = false;
  double wrong_m = 1.0;
  double wrong_deg = 2.0;
  double tolerance_s = EvaluationConfig().time_tolerance_s;
};

CommandResult run(const Options& options) {
  const auto truth = read_tum(options.truth);
  const auto trajectory = truth ? read_tum(options.trajectory) : truth;
  if (!trajectory) {
    return tl::unexpected(CommandError{trajectory.error().message + '\n', EX_DATAERR});
  }
  if (truth->empty()) {
    return tl::unexpected(
        CommandError{options.truth + ": holds no pose; name the file of the true poses\n", EX_DATAERR});
  }
  if (trajectory->empty()) {
    return tl::unexpected(CommandError{
        options.trajectory + ": holds no pose; name the trajectory.tum of a replay that had a fix\n",
        EX_DATAERR});
  }
  EvaluationConfig config;
  config.wrong_distance_m = options.wrong_m;
  config.wrong_heading_rad = options.wrong_deg * core::kDegree;
  config.time_tolerance_s = options.tolerance_s;
  const auto evaluation = evaluate(*truth, *trajectory, config);
  if (!evaluation) {
    return tl::unexpected(CommandError{evaluation.error().message + '\n', EX_DATAERR});
  }
  std::fputs((options.json ? evaluation_json(*evaluation) : evaluation_text(*evaluation)).c_str(), stdout);
  if (has_nothing_in_common(*evaluation)) {
    return tl::unexpected(CommandError{
        options.trajectory + ": no pose has a time of " + options.truth + " within " +
            shown(options.tolerance_s) + " s; check that both count time alike, or raise --time-tolerance\n",
        EX_DATAERR});
  }
  return EX_OK;
}

}  // namespace

void add_eval(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("eval", "compare a trajectory with the truth: fixes, wrong fixes, errors");
  verb->add_option("--truth", options->truth, "true poses")->required()->type_name("T.tum");
  verb->add_flag("--json", options->json, "print one JSON object");
  verb->add_option("--wrong-distance", options->wrong_m, "a fix farther off than this is wrong, m")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->check(is_finite);
  verb->add_option("--wrong-heading", options->wrong_deg, "a fix turned by more than this is wrong, deg")
      ->capture_default_str()
      ->check(CLI::PositiveNumber)
      ->check(is_finite);
  verb->add_option("--time-tolerance", options->tolerance_s,
                   "a fix belongs to the nearest true pose if their times differ by no more, s")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->check(is_finite);
  verb->add_option("TRAJECTORY", options->trajectory, "trajectory.tum of a replay")
      ->required()
      ->type_name("F.tum");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
