#pragma once

#include "tools/input/input_error.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <filesystem>
#include <string>

namespace slamsensor::tools {

/// Larger files are refused before anything is allocated for them.
inline constexpr std::size_t kFileBytesMax = std::size_t{2} << 30;

/// The bytes of a regular file, at most the first `bytes_max`. An error when it does not exist, is not a
/// regular file, cannot be read, or (when asked for all of it) is larger than kFileBytesMax.
[[nodiscard]] tl::expected<std::string, InputError> read_file(const std::filesystem::path& path,
                                                              std::size_t bytes_max = kFileBytesMax);

}  // namespace slamsensor::tools
