#pragma once

#include "firmware/config/layered_config.hpp"
#include "tools/commands/command.hpp"
#include "tools/world/simulate.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// The configuration of a verb: defaults < --config FILE < FILE.d/*.toml < --set KEY=VALUE.
struct ConfigOptions {
  std::string file;
  std::vector<std::string> settings;

  /// Adds --config and --set to a verb.
  void add_to(CLI::App& verb);

  /// The same for a configuration that is loaded again and again.
  [[nodiscard]] firmware::ConfigSources sources() const;
};

/// The options laid over `base`, or every mistake in it, one line each (EX_CONFIG).
[[nodiscard]] tl::expected<firmware::LoadedConfig, CommandError> load(const ConfigOptions& options,
                                                                      firmware::LoadedConfig base = {});

/// The options of a simulated drive, shared by the verbs that make one.
struct DriveOptions {
  SimulateOptions simulate;
  std::uint32_t experiment = 1;  ///< of the paper: which sweep

  /// Adds --scans, --step, --kidnaps, --seed, --experiment to a verb.
  void add_to(CLI::App& verb);

  /// Runs the simulation into `simulate.out`, with a progress bar.
  [[nodiscard]] tl::expected<SimulateSummary, CommandError> run();
};

/// A progress bar on standard error; silent when that is no terminal. One thread.
class ProgressBar {
 public:
  explicit ProgressBar(std::string_view what);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  /// Clears the line.
  ~ProgressBar();

  /// Draws the bar when it has changed by a percent.
  void update(std::size_t done, std::size_t total);

 private:
  std::string_view what_;
  bool visible_;
  std::size_t percent_ = 101;
};

}  // namespace slamsensor::tools
