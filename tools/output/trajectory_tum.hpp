#pragma once

#include "tools/eval/timed_pose.hpp"
#include "tools/output/fixes_csv.hpp"
#include "tools/output/write_file.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// The poses of the rows that are a fix in the home map of the last row, in their order; an ambiguous pose is
/// none.
[[nodiscard]] std::vector<TimedPose> trajectory_of(std::span<const FixRow> rows);

/// The whole of a trajectory in the format of the TUM RGB-D benchmark: a line `t x y z qx qy qz qw` per pose,
/// t in s as short as it reads back the same, metres with 6 decimals, the quaternion with 9 (its qw is never
/// negative).
[[nodiscard]] std::string format_trajectory(std::span<const TimedPose> poses);

/// `path` holds `format_trajectory(poses)`, or is as it was and the error says why.
[[nodiscard]] tl::expected<void, OutputError> write_trajectory(const std::filesystem::path& path,
                                                               std::span<const TimedPose> poses);

}  // namespace slamsensor::tools
