#pragma once

#include "tools/world/section.hpp"
#include "tools/world/world_config.hpp"

#include <optional>
#include <vector>

namespace slamsensor::tools {

/// Every table of a world file that appears at most once. The pointers are into `config`.
[[nodiscard]] std::vector<Section> sections_of(WorldConfig& config);

/// The keys of one [[wall]], [[mover]], [[stand]].
[[nodiscard]] Section section_of(WallConfig& wall);
[[nodiscard]] Section section_of(MoverConfig& mover);
[[nodiscard]] Section section_of(StandConfig& stand);

/// What is wrong with `config`, if anything: a value out of its range, an empty interval or area, too many
/// objects.
[[nodiscard]] std::optional<WorldError> find_problem(const WorldConfig& config);

}  // namespace slamsensor::tools
