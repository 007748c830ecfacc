#pragma once

#include "firmware/config/layered_config.hpp"
#include "tools/world/simulate.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <sysexits.h>
#include <vector>

namespace CLI {
class App;
}

namespace slamsensor::tools {

/// Why a verb failed: one or more lines for the user, and the exit status that scripts see (sysexits).
struct CommandError {
  std::string message;
  int exit_status = EX_SOFTWARE;
};

/// What a verb returns: its exit status.
using CommandResult = tl::expected<int, CommandError>;

/// Each adds its verb to `app`; the verb runs when it is parsed and leaves its result in `result`.
void add_replay(CLI::App& app, CommandResult& result);
void add_locate(CLI::App& app, CommandResult& result);
void add_eval(CLI::App& app, CommandResult& result);
void add_simulate(CLI::App& app, CommandResult& result);
void add_demo(CLI::App& app, CommandResult& result);
void add_emulate(CLI::App& app, CommandResult& result);
void add_record(CLI::App& app, CommandResult& result);
void add_top(CLI::App& app, CommandResult& result);
void add_view(CLI::App& app, CommandResult& result);
void add_map(CLI::App& app, CommandResult& result);
void add_ctl(CLI::App& app, CommandResult& result);
void add_edges(CLI::App& app, CommandResult& result);
void add_memory(CLI::App& app, CommandResult& result);
void add_check_config(CLI::App& app, CommandResult& result);

/// A check of an option's number, which may be written as "nan" or "inf": what is wrong, or nothing.
[[nodiscard]] std::string is_finite(const std::string& number);

/// The configuration of a verb: defaults < --config FILE < FILE.d/*.toml < --set KEY=VALUE.
struct ConfigOptions {
  std::string file;
  std::vector<std::string> settings;

  /// Adds --config and --set to a verb.
  void add_to(CLI::App& verb);

  /// The same for a configuration that is loaded again and again.
  [[nodiscard]] firmware::ConfigSources sources() const;

  /// The files that are read for it: that of --config and its drop-ins.
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
};

/// check_outputs for a verb, before it begins (EX_CANTCREAT).
[[nodiscard]] tl::expected<void, CommandError> refuse_own_inputs(
    std::span<const std::filesystem::path> outputs, std::span<const std::filesystem::path> inputs);

/// The options laid over `base`, or every mistake in it, one line each (EX_CONFIG). Keys that have no effect
/// any more are named on standard error.
[[nodiscard]] tl::expected<firmware::LoadedConfig, CommandError> load(const ConfigOptions& options,
                                                                      firmware::LoadedConfig base = {});

/// What a verb reads whose inputs are scans: `inputs`, of folders among them the files that are scans, and
/// the configuration.
[[nodiscard]] std::vector<std::filesystem::path> files_read(std::span<const std::filesystem::path> inputs,
                                                            const ConfigOptions& options);

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
