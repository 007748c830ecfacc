#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// The files of one named map in a folder.
struct MapPaths {
  std::filesystem::path current;    ///< NAME.slammap
  std::filesystem::path previous;   ///< NAME.slammap.1, the generation before
  std::filesystem::path temporary;  ///< NAME.slammap.tmp, the next generation while it is written
  std::filesystem::path keeping;  ///< NAME.slammap.1.tmp, a second name of `current` on its way to `previous`
};

[[nodiscard]] MapPaths paths_of(const std::filesystem::path& folder, std::string_view name);

/// What a file of a map folder is.
enum class MapFileRole : std::uint8_t { Current, Previous, Temporary, SetAside };

struct MapFileName {
  std::string name;
  MapFileRole role = MapFileRole::Current;
};

/// The map and role of a file by its name; none when it is no file of a store.
[[nodiscard]] std::optional<MapFileName> parse_file_name(std::string_view file);

/// A name in the folder of `paths` that nothing has yet, for a file of its map that is not good:
/// NAME.slammap.bad-20261123T130509Z, with -2 to -99 behind it when that is taken; none when all are.
[[nodiscard]] std::optional<std::filesystem::path> free_bad_path(const MapPaths& paths,
                                                                 std::int64_t now_utc_s);

}  // namespace slamsensor::firmware
