#pragma once

#include "tools/emulator/scenario.hpp"
#include "tools/world/section.hpp"

#include <string>
#include <vector>

namespace slamsensor::tools {

/// What a scenario file says that goes into a Scenario by a detour.
struct ScenarioExtras {
  std::string world;             ///< path of the world file
  std::uint64_t world_seed = 0;  ///< instead of the one in the world file; 0 for that one
  HeadKind head = HeadKind::Paper;
  double path_step_m = 5.0;  ///< from a stand to the next on the path of the waypoints
  std::vector<StandConfig> stands;
  std::vector<core::Point2> waypoints;
};

/// The keys at the top of a scenario file that say what the others start from.
[[nodiscard]] Section base_section(Scenario& scenario, ScenarioExtras& extras);

/// Its tables that appear at most once. The pointers are into the arguments.
[[nodiscard]] std::vector<Section> sections_of(Scenario& scenario, ScenarioExtras& extras);

/// The keys of one [[waypoint]], [[kidnap]], [[fault]], [[fault_rate]]; those of a [[stand]] are those of a
/// world's.
[[nodiscard]] Section waypoint_section(core::Point2& waypoint_W);
[[nodiscard]] Section kidnap_section(Kidnap& kidnap);
[[nodiscard]] Section fault_section(PlannedFault& fault, const HeadProfile& head);
[[nodiscard]] Section rate_section(FaultRate& rate, const HeadProfile& head);

/// Stands every `step_m` (positive) along the line through `waypoints_W` (two or more, no two neighbours at
/// one place), each with the heading of the line; the first at its begin.
[[nodiscard]] std::vector<StandConfig> stands_on_path(const std::vector<core::Point2>& waypoints_W,
                                                      double step_m);

}  // namespace slamsensor::tools
