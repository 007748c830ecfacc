#include "tools/commands/command.hpp"

#include "tools/input/scan_source.hpp"
#include "tools/input/text.hpp"
#include "tools/output/text_output.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <utility>

namespace slamsensor::tools {

std::string is_finite(const std::string& number) {
  const auto value = parse_number(number);
  return value && std::isfinite(*value) ? std::string() : number + " is no finite number";
}

void ConfigOptions::add_to(CLI::App& verb) {
  verb.add_option("-c,--config", file, "configuration file (TOML); see config/")->type_name("FILE");
  verb.add_option("--set", settings,
                  "one setting on top of the file, for example association.tolerance_m=0.75")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

firmware::ConfigSources ConfigOptions::sources() const {
  firmware::ConfigSources sources{.file = file};
  for (const std::string& setting : settings) {
    if (auto assignment = firmware::parse_assignment(setting)) {
      sources.settings.push_back(std::move(*assignment));
    } else {
      sources.mistakes.push_back({{"--set", 0, 0}, firmware::printable(setting), assignment.error()});
    }
  }
  return sources;
}

std::vector<std::filesystem::path> ConfigOptions::files() const {
  std::vector<std::filesystem::path> files;
  if (file.empty()) {
    return files;
  }
  if (auto drop_ins = firmware::drop_in_files(file)) {
    files = std::move(*drop_ins);
  }
  files.emplace_back(file);
  return files;
}

tl::expected<void, CommandError> refuse_own_inputs(std::span<const std::filesystem::path> outputs,
                                                   std::span<const std::filesystem::path> inputs) {
  return check_outputs(outputs, inputs).map_error([](const OutputError& error) {
    return CommandError{error.message + '\n', EX_CANTCREAT};
  });
}

std::vector<std::filesystem::path> files_read(std::span<const std::filesystem::path> inputs,
                                              const ConfigOptions& options) {
  std::vector<std::filesystem::path> files = options.files();
  files.insert(files.end(), inputs.begin(), inputs.end());
  if (const auto found = find_scan_files(inputs)) {
    for (const ScanFile& file : found->scans) {
      files.push_back(file.path);
    }
  }
  return files;
}

tl::expected<firmware::LoadedConfig, CommandError> load(const ConfigOptions& options,
                                                        firmware::LoadedConfig base) {
  auto loaded = firmware::load_layers(options.sources(), std::move(base));
  if (!loaded) {
    return tl::unexpected(CommandError{firmware::error_lines(loaded.error()), EX_CONFIG});
  }
  std::fputs(firmware::error_lines(loaded->warnings).c_str(), stderr);
  return std::move(*loaded);
}

void DriveOptions::add_to(CLI::App& verb) {
  verb.add_option("--scans", simulate.drive.stands, "scans to make")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  verb.add_option("--step", simulate.drive.step_m, "way from one scan to the next, m")
      ->check(CLI::PositiveNumber)
      ->check(is_finite)
      ->capture_default_str();
  verb.add_option("--kidnaps", simulate.drive.kidnap_share,
                  "share of scans made near some earlier one instead of a step further")
      ->check(CLI::Range(0.0, 1.0))
      ->check(is_finite)
      ->capture_default_str();
  verb.add_option("--seed", simulate.seed, "of the drive and of the noise")->capture_default_str();
  verb.add_option("--world-seed", simulate.world_seed, "of the world, instead of the one in its file");
  verb.add_option("--experiment", experiment, "sweep of the paper's experiment I, II, III or IV")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
}

tl::expected<SimulateSummary, CommandError> DriveOptions::run() {
  const std::array<std::filesystem::path, 1> world{simulate.world};
  if (auto checked = refuse_own_inputs(simulated_files(simulate), world); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  simulate.sweep = experiment <= 2 ? paper_sweep_1_2() : paper_sweep_3_4();
  ProgressBar bar("simulate");
  simulate.on_progress = [&](const SimulateProgress& progress) {
    bar.update(progress.scans_done, progress.scans);
  };
  return tools::simulate(simulate).map_error([](const WorldError& error) {
    return CommandError{error.message + '\n', EX_DATAERR};
  });
}

ProgressBar::ProgressBar(std::string_view what) : what_(what), visible_(isatty(STDERR_FILENO) == 1) {
}

ProgressBar::~ProgressBar() {
  if (visible_) {
    std::fputs("\r\033[K", stderr);
  }
}

void ProgressBar::update(std::size_t done, std::size_t total) {
  const std::size_t percent = total == 0 ? 100 : 100 * done / total;
  if (!visible_ || percent == percent_) {
    return;
  }
  percent_ = percent;
  std::string bar(percent * 40 / 100, '#');
  bar.resize(40, '.');
  std::fprintf(stderr, "\r%.*s [%s] %3zu %% (%zu of %zu)", static_cast<int>(what_.size()), what_.data(),
               bar.c_str(), percent, done, total);
}

}  // namespace slamsensor::tools
