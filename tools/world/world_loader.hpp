#pragma once

#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <string_view>

namespace slamsensor::tools {

/// The world that the TOML file `path` describes; what it does not name keeps its default. A key that is not
/// known, has another type or is out of range is refused with file, line and column. The stems of
/// `trees.stems_csv`, relative to the file's folder, are in `stems`.
[[nodiscard]] tl::expected<WorldConfig, WorldError> load_world(const std::filesystem::path& path);

/// The same from a text; `name` stands for the file in messages, and a relative `trees.stems_csv` is looked
/// for in `folder`.
[[nodiscard]] tl::expected<WorldConfig, WorldError> parse_world(std::string_view toml, std::string_view name,
                                                                const std::filesystem::path& folder);

}  // namespace slamsensor::tools
