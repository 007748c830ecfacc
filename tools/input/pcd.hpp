#pragma once

#include "core/reading.hpp"
#include "firmware/config/sensor_config.hpp"
#include "tools/input/text.hpp"

#include <Eigen/Core>
#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A field `ring` holds at most this.
inline constexpr std::uint32_t kRingMax = 65'535;

/// A return of a point cloud.
struct CloudPoint {
  Eigen::Vector3d position_L = Eigen::Vector3d::Zero();  ///< sensor frame, m; never the origin
  std::uint32_t ring = 0;                                ///< 0 without a ring field
};

/// The points of a cloud that have a direction, in the order of the file.
struct PointCloud {
  std::vector<CloudPoint> points;
  bool has_ring = false;
  std::size_t points_skipped =
      0;  ///< a coordinate is NaN, or all are 0, or it is the sensor's own place: nothing came back
  std::string remark;  ///< what of the file was not read, or is too coarse; empty when nothing is
};

/// The cloud in a PCD file's bytes: DATA ascii, binary (little-endian) or binary_compressed. VIEWPOINT is the
/// sensor's pose in the frame of the file's points, and they are taken into the sensor's frame. An error,
/// with the line or the byte, when the header is refused (parse_pcd_header), the file holds fewer points than
/// declared, a coordinate is infinite or no number, a point is farther than kInputReach_m, or a ring is
/// not a whole number up to kRingMax.
[[nodiscard]] tl::expected<PointCloud, InputError> parse_pcd(std::string_view bytes, std::string_view name);

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
