#pragma once

#include "tools/world/drive.hpp"
#include "tools/world/sweep.hpp"

#include <tl/expected.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// "scan_0001.csv" for 1; more digits from 10000 on.
[[nodiscard]] std::string scan_file_name(std::size_t number);

/// `pan_deg,tilt_deg,range_m`, a line per reading in the order of time; angles to 1e-5 deg, ranges to 1 mm.
[[nodiscard]] std::string format_scan(const std::vector<std::vector<core::Reading>>& lines);

/// `t x y z qx qy qz qw` per stand; t counts scans from 1.
[[nodiscard]] std::string format_truth(const World& world, const SweepConfig& sweep,
                                       std::span<const Stand> stands);

/// `id,x_m,y_m,radius_m,height_m,kind` per object; id counts from 1.
[[nodiscard]] std::string format_stems(std::span<const Object> objects);

}  // namespace slamsensor::tools
