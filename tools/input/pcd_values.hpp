#pragma once

#include "tools/input/pcd_header.hpp"

#include <cstddef>
#include <string_view>

namespace slamsensor::tools {

/// One field of all points of a cloud, as bytes: the value of point i starts `first_bytes + i * step_bytes`
/// into `bytes`.
struct PcdColumn {
  std::string_view bytes;
  std::size_t first_bytes = 0;
  std::size_t step_bytes = 0;
  PcdType type = PcdType::Float;
  std::size_t size_bytes = 0;

  /// The value of point `i` as a double (exact but for 64-bit integers beyond 2^53); NaN when it is not
  /// within `bytes`.
  [[nodiscard]] double value(std::size_t i) const;
};

/// The column of `field` in points of `stride_bytes` that follow each other (DATA binary).
[[nodiscard]] PcdColumn column_of_points(std::string_view bytes, const PcdField& field,
                                         std::size_t stride_bytes);

/// The column of `field` in fields that follow each other, all points of the first before the second's (what
/// binary_compressed unpacks to); `first_bytes` is where it starts.
[[nodiscard]] PcdColumn column_of_fields(std::string_view bytes, const PcdField& field,
                                         std::size_t first_bytes);

}  // namespace slamsensor::tools
