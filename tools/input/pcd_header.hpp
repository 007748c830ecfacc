#pragma once

#include "tools/input/text.hpp"

#include <Eigen/Geometry>
#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Bounds of what a header may declare; nothing is allocated for a declared size before the file is known to
/// hold it.
inline constexpr std::size_t kPcdHeaderBytesMax = std::size_t{64} * 1024;
inline constexpr std::size_t kPcdFieldsMax = 256;
inline constexpr std::uint64_t kPcdCountMax = 4096;
inline constexpr std::uint64_t kPcdPointsMax = 20'000'000;

/// A viewpoint farther from the origin of its frame than this is no place on the earth.
inline constexpr double kPcdViewpointReach_m = 1e8;

enum class PcdData : std::uint8_t { Ascii, Binary, BinaryCompressed };

enum class PcdType : std::uint8_t { Signed, Unsigned, Float };

/// One field of a point.
struct PcdField {
  std::string name;  ///< "_" is padding
  PcdType type = PcdType::Float;
  std::size_t size_bytes = 0;    ///< of one value: 1, 2, 4 or 8; 4 or 8 for Float
  std::size_t count = 1;         ///< values per point; 0 for padding that some writers leave
  std::size_t offset_bytes = 0;  ///< from the start of the point, padding included
  std::size_t first_value = 0;   ///< place of its first value among all values of a point

  [[nodiscard]] std::size_t total_bytes() const { return size_bytes * count; }
  [[nodiscard]] bool is_padding() const { return name == "_"; }
};

/// The header of a point cloud file. `x`, `y`, `z` and `ring` index `fields`; each has count 1.
struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t x = 0;
  std::size_t y = 0;
  std::size_t z = 0;
  std::optional<std::size_t> ring;
  std::size_t points = 0;        ///< 0 to kPcdPointsMax
  std::size_t stride_bytes = 0;  ///< of a point
  std::size_t values = 0;        ///< of a point
  Eigen::Isometry3d T_cloud_L =
      Eigen::Isometry3d::Identity();  ///< VIEWPOINT: the sensor in the points' frame
  PcdData data = PcdData::Ascii;
  std::size_t data_offset_bytes = 0;  ///< where the points start
  std::size_t data_line = 0;          ///< number of the line that starts there
};

/// The header that `bytes` start with, in the format of the Point Cloud Library's "The PCD file format",
/// version 0.7. Keys may come in any order, DATA last; COUNT, VERSION and VIEWPOINT may be left out. Keys,
/// field names, types and the kind of data may be in upper or lower case. An error, with the line, when a key
/// is missing, unknown or there twice, lists differ in length, a type does not exist, x, y or z is missing,
/// VIEWPOINT is no pose, or a size is out of bounds or contradicts another.
[[nodiscard]] tl::expected<PcdHeader, InputError> parse_pcd_header(std::string_view bytes,
                                                                   std::string_view name);

}  // namespace slamsensor::tools
