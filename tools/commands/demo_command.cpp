#include "core/fix.hpp"
#include "tools/commands/command.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/input/text_files.hpp"
#include "tools/output/result_files.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/replay_report.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>
#include <vector>

namespace slamsensor::tools {
namespace {

struct Options {
  DriveOptions drive;
  ConfigOptions config;
  std::filesystem::path out = "out/demo";
};

void print_heading() {
  std::printf("%5s  %-9s %9s %9s %9s  %7s %5s %3s\n", "scan", "status", "x m", "y m", "heading", "matches",
              "map", "xi");
}

void print_fix(const FixRow& row) {
  const core::Fix& fix = row.fix;
  const std::string_view status = core::to_string(fix.status);
  std::printf("%5lld  %-9.*s ", static_cast<long long>(row.scan), static_cast<int>(status.size()),
              status.data());
  if (fix.status == core::FixStatus::NoFix) {
    const std::string_view reason = core::to_string(fix.reason);
    std::printf("%.*s\n", static_cast<int>(reason.size()), reason.data());
  } else {
    std::printf("%9.2f %9.2f %8.1f\u00b0  %3u/%-3u %5u %3u\n", fix.pose_W.x_m, fix.pose_W.y_m,
                fix.pose_W.heading_rad / core::kDegree, fix.matches, fix.landmarks_seen, fix.landmarks_in_map,
                fix.error_xi);
  }
  std::fflush(stdout);
}

tl::expected<void, CommandError> clear_scans(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::remove_all(folder, error);
  if (error) {
    return tl::unexpected(
        CommandError{folder.string() + ": " + error.message() + "; choose another --out\n", EX_CANTCREAT});
  }
  return {};
}

CommandResult run(Options& options) {
  const auto loaded = load(options.config);
  if (!loaded) {
    return tl::unexpected(loaded.error());
  }
  std::vector<std::filesystem::path> inputs = options.config.files();
  inputs.emplace_back(options.drive.simulate.world);
  if (auto checked = refuse_own_inputs(replay_files(options.out), inputs); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  const std::filesystem::path scans = options.out / "scans";
  if (const auto cleared = clear_scans(scans); !cleared) {
    return tl::unexpected(cleared.error());
  }
  options.drive.simulate.out = scans;
  std::printf(
      "A sensor is carried through a simulated bush world, and kidnapped now and then. It knows neither "
      "where it\n"
      "starts nor how it moved: every scan is matched with the map that it builds itself.\n\n");
  const auto simulated = options.drive.run();
  if (!simulated) {
    return tl::unexpected(simulated.error());
  }
  print_heading();
  const auto result =
      replay({scans}, loaded->config, [](std::size_t, std::size_t, const FixRow& row) { print_fix(row); });
  const auto truth = read_tum(scans / "truth.tum");
  if (!result || !truth) {
    return tl::unexpected(
        CommandError{(result ? truth.error() : result.error()).message + '\n', EX_SOFTWARE});
  }
  const auto evaluation = evaluate(*truth, trajectory_of(result->rows));
  if (!evaluation) {
    return tl::unexpected(CommandError{evaluation.error().message + '\n', EX_SOFTWARE});
  }
  const auto written =
      write_replay(*result, loaded->config, *truth, *evaluation, MeasuredTimes::Written, options.out);
  if (!written) {
    return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
  }
  std::printf("\n%s%s\npicture: %s   NMEA: %s\n", replay_summary(*result).c_str(),
              evaluation_text(*evaluation).c_str(), (options.out / "plot.svg").c_str(),
              (options.out / "track.nmea").c_str());
  return EX_OK;
}

}  // namespace

void add_demo(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  options->drive.simulate.drive.stands = 30;
  options->drive.simulate.drive.kidnap_share = 0.15;
  CLI::App* verb =
      app.add_subcommand("demo", "the main job on a simulated bush world: scans, fixes, map, picture");
  options->config.add_to(*verb);
  options->drive.add_to(*verb);
  verb->add_option("--world", options->drive.simulate.world, "world file (TOML)")
      ->required()
      ->type_name("FILE");
  verb->add_option("--out", options->out, "folder for the results")->capture_default_str();
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
