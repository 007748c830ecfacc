#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Whether `name` can be that of a map: 1 to 64 characters out of A-Z a-z 0-9 _ -.
[[nodiscard]] bool is_map_name(std::string_view name);

/// Whether `seconds` since 1970-01-01 UTC lie before the year 10000.
[[nodiscard]] bool is_utc(std::int64_t seconds);

/// "2026-11-23T13:05:09Z"; a time that is not `is_utc` is the nearest that is.
[[nodiscard]] std::string utc_text(std::int64_t seconds);

/// "20261123T130509Z", for names of files.
[[nodiscard]] std::string utc_name(std::int64_t seconds);

/// The bytes in quotes as printable ASCII, anything else as \xHH; what is longer than 32 is cut.
[[nodiscard]] std::string printable_bytes(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::string printable_bytes(std::string_view text);

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
