#pragma once

#include "tools/eval/timed_pose.hpp"
#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// The trajectory that a text in the format of the TUM RGB-D benchmark holds (`t x y z qx qy qz qw` per line,
/// '#' comments), by increasing t; z is dropped and the heading is the yaw of the quaternion, which may be
/// off unit length by 1 %. A text without a pose is an empty trajectory. An error, with the line, when a line
/// has not eight finite numbers, a t occurs twice, or a quaternion is not a rotation or points straight up or
/// down.
[[nodiscard]] tl::expected<std::vector<TimedPose>, InputError> parse_tum(std::string_view text,
                                                                         std::string_view name);

/// parse_tum on a file.
[[nodiscard]] tl::expected<std::vector<TimedPose>, InputError> read_tum(const std::filesystem::path& path);

}  // namespace slamsensor::tools
