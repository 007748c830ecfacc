#pragma once

#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// The keys of a PCD header, as indices of kPcdKeys.
enum PcdKey : std::size_t {
  kVersion,
  kFields,
  kSize,
  kType,
  kCount,
  kWidth,
  kHeight,
  kViewpoint,
  kPoints,
  kData
};
inline constexpr std::array<std::string_view, 10> kPcdKeys{
    "VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

/// The line of a key.
struct PcdEntry {
  std::vector<std::string_view> words;
  std::size_t line = 0;  ///< 0: the key has not come
};

/// The lines of a header.
struct PcdEntries {
  std::array<PcdEntry, kPcdKeys.size()> of_key;
  std::size_t end_bytes = 0;  ///< where the line after DATA begins
  std::size_t last_line = 0;  ///< number of the DATA line
};

/// The lines that `bytes` begin with, up to DATA; keys in upper or lower case. An error when a key is unknown
/// or there twice, or no DATA line comes within kPcdHeaderBytesMax.
[[nodiscard]] tl::expected<PcdEntries, InputError> read_pcd_entries(std::string_view bytes,
                                                                    std::string_view name);

/// An error when a key that every header has is missing.
[[nodiscard]] tl::expected<void, InputError> check_pcd_entries(const PcdEntries& entries,
                                                               std::string_view name);

}  // namespace slamsensor::tools
