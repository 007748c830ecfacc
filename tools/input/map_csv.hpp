#pragma once

#include "core/geometry/pose2.hpp"
#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A landmark of a map file.
struct MapPoint {
  std::int64_t id = 0;
  core::Point2 position_W = core::Point2::Zero();  ///< m
};

/// The landmarks of a map (`id,x_m,y_m` in any order, further columns ignored), in the order of the file, at
/// least one. An error, with the line, when an id is not a whole number or occurs twice, or a coordinate is
/// not a number within core::kLatticeReach_m.
[[nodiscard]] tl::expected<std::vector<MapPoint>, InputError> parse_map_csv(std::string_view text,
                                                                            std::string_view name);

/// parse_map_csv on a file.
[[nodiscard]] tl::expected<std::vector<MapPoint>, InputError> read_map_csv(const std::filesystem::path& path);

}  // namespace slamsensor::tools
