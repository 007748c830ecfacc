#pragma once

#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Stem positions, m, from a CSV whose first line names its columns, among them x and y, or x_m and y_m; a
/// leading '#' and what follows a name after a space are passed over, other columns are ignored, as are empty
/// lines and later lines that start with '#'. A row without two finite numbers there is refused with its
/// line.
[[nodiscard]] tl::expected<std::vector<core::Point2>, WorldError> load_stems(
    const std::filesystem::path& path);

/// The same from a text; `name` stands for the file in messages.
[[nodiscard]] tl::expected<std::vector<core::Point2>, WorldError> parse_stems(std::string_view csv,
                                                                              std::string_view name);

}  // namespace slamsensor::tools
