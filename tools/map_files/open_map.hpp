#pragma once

#include "firmware/store/map_file.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <filesystem>
#include <string>

namespace slamsensor::tools {

/// A map that a user named, and where it was found.
struct OpenedMap {
  firmware::MapFile map;
  std::filesystem::path path;
  std::size_t bytes = 0;
  std::string warning;  ///< why it is not the newest generation; empty when it is
};

/// The map of that file, or, where `name` is no file, the map of that name in the store `folder`. The error
/// says in one line what is wrong and what to do.
[[nodiscard]] tl::expected<OpenedMap, std::string> open_map(const std::string& name,
                                                            const std::filesystem::path& folder);

}  // namespace slamsensor::tools
