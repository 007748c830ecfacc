#include "tools/commands/drive_options.hpp"

#include "tools/commands/progress_bar.hpp"

#include <CLI/CLI.hpp>

namespace slamsensor::tools {

void DriveOptions::add_to(CLI::App& verb) {
  verb.add_option("--scans", simulate.drive.stands, "scans to make")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  verb.add_option("--step", simulate.drive.step_m, "way from one scan to the next, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb.add_option("--kidnaps", simulate.drive.kidnap_share,
                  "share of scans made near some earlier one instead of a step further")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.add_option("--seed", simulate.seed, "of the drive and of the noise")->capture_default_str();
  verb.add_option("--world-seed", simulate.world_seed, "of the world, instead of the one in its file");
  verb.add_option("--experiment", experiment, "sweep of the paper's experiment I, II, III or IV")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
}

tl::expected<SimulateSummary, CommandError> DriveOptions::run() {
  simulate.sweep = experiment <= 2 ? paper_sweep_1_2() : paper_sweep_3_4();
  ProgressBar bar("simulate");
  simulate.on_progress = [&](const SimulateProgress& progress) {
    bar.update(progress.scans_done, progress.scans);
  };
  return tools::simulate(simulate).map_error([](const WorldError& error) {
    return CommandError{error.message + '\n', EX_DATAERR};
  });
}

}  // namespace slamsensor::tools
