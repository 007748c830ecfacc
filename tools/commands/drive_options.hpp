#pragma once

#include "tools/commands/command.hpp"
#include "tools/world/simulate.hpp"

#include <cstdint>
#include <string>

namespace slamsensor::tools {

/// The options of a simulated drive, shared by the verbs that make one.
struct DriveOptions {
  SimulateOptions simulate;
  std::uint32_t experiment = 1;  ///< of the paper: which sweep

  /// Adds --scans, --step, --kidnaps, --seed, --experiment to a verb.
  void add_to(CLI::App& verb);

  /// Runs the simulation into `simulate.out`, with a progress bar.
  [[nodiscard]] tl::expected<SimulateSummary, CommandError> run();
};

}  // namespace slamsensor::tools
