#pragma once

#include "core/reading.hpp"
#include "firmware/config/config.hpp"
#include "tools/input/input_error.hpp"
#include "tools/input/pcd.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A cloud that becomes more readings than this is refused.
inline constexpr std::size_t kCloudReadingsMax = 20'000'000;

/// The scanlines of `cloud`, each by increasing pan in [0, 2 pi): one per ring by increasing ring, or,
/// without rings, one per `tilt_step_rad` of elevation by increasing elevation. The attitude is taken out
/// first: a point p becomes R_y(pitch) R_x(roll) p (right-handed; positive pitch is nose down). With
/// `absent_is_no_return` every column of `bearing_step_rad` (core::DetectionConfig) that no point of the
/// scanline fell into gets a reading without return at its centre, at the tilt of the reading before it on
/// the circle. Both steps must be positive. An error when that makes more than kCloudReadingsMax readings.
[[nodiscard]] tl::expected<std::vector<std::vector<core::Reading>>, InputError> scanlines_of_cloud(
    const PointCloud& cloud, const firmware::PointCloudConfig& config, double bearing_step_rad,
    std::string_view name);

}  // namespace slamsensor::tools
