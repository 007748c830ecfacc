#pragma once

#include "tools/input/input_error.hpp"

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
  std::string remark;  ///< one line on bytes of the file that were not read; empty when there are none
};

/// The cloud in a PCD file's bytes: DATA ascii, binary (little-endian) or binary_compressed. VIEWPOINT is the
/// sensor's pose in the frame of the file's points, and they are taken into the sensor's frame. An error,
/// with the line or the byte, when the header is refused (parse_pcd_header), the file holds fewer points than
/// declared, a coordinate is infinite or no number, a point is farther than kInputReach_m, or a ring is
/// not a whole number up to kRingMax.
[[nodiscard]] tl::expected<PointCloud, InputError> parse_pcd(std::string_view bytes, std::string_view name);

}  // namespace slamsensor::tools
