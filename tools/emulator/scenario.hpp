#pragma once

#include "tools/emulator/fault_plan.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/stand_plan.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/sweep.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// All that an emulated head does, from its world to its faults. The same values, the same bytes.
struct Scenario {
  WorldConfig world;  ///< its stands, when it has any, are where the sensor is put, in order
  std::uint64_t seed = 1;
  HeadProfile head;
  SweepConfig mount;  ///< height, roll and pitch of the mount; the rest is not used
  StandChange change = StandChange::AtTimes;
  DriveConfig drive;  ///< a walk by chance when there are no stands; its period is the dwell at each stand
  std::vector<Kidnap> kidnaps;
  std::vector<PlannedFault> faults;
  std::vector<FaultRate> rates;
  std::size_t truth_max = 0;  ///< readings whose truth is kept; not in the file
};

/// The scenario that the TOML file `path` describes, or, for a world file (one that names no `world`), a
/// drive through that world with the head `kind`. `kind`, when given, also replaces the scenario's own. What
/// is not named keeps its default. Every mistake is told with file, line and column.
[[nodiscard]] tl::expected<Scenario, WorldError> load_scenario(const std::filesystem::path& path,
                                                               std::optional<HeadKind> kind = std::nullopt);

/// The same from a text; `name` stands for the file in messages, and the world is looked for in `folder`.
[[nodiscard]] tl::expected<Scenario, WorldError> parse_scenario(std::string_view toml, std::string_view name,
                                                                const std::filesystem::path& folder,
                                                                std::optional<HeadKind> kind = std::nullopt);

/// What is wrong with a scenario that was made otherwise than by the above: a fault that its device cannot
/// have, and the like.
[[nodiscard]] std::optional<WorldError> find_problem(const Scenario& scenario);

}  // namespace slamsensor::tools
