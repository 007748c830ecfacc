#pragma once

#include <tl/expected.hpp>

#include <filesystem>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// Why an output could not be written: path, the system's reason and what to do, in one line.
struct OutputError {
  std::string message;
};

/// `path` holds exactly `bytes`, on the disk, or still holds what it held before and an error is returned:
/// the bytes go to a new file in the same folder, which takes the name only when all of it is written and
/// closed without error. A symbolic link is followed. A path that is no regular file (a pipe, a device) is
/// written to directly.
[[nodiscard]] tl::expected<void, OutputError> write_file(const std::filesystem::path& path,
                                                         std::string_view bytes);

}  // namespace slamsensor::tools
