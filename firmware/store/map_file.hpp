#pragma once

#include "core/mapping/map_state.hpp"
#include "firmware/config/sensor_config.hpp"
#include "firmware/store/map_file.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// The settings that a map was made with. For the reader's information: a map may be used with others.
struct MapMethod {
  double tolerance_m = 0.0;
  double range_step_m = 0.0;
  double bearing_step_rad = 0.0;
  std::uint32_t depth = 0;
  std::uint32_t landmarks_max = 0;
};

/// What a map file says of its map. Times are seconds since 1970-01-01 UTC; 0 is unknown.
struct MapAbout {
  std::string name;
  std::int64_t created_utc_s = 0;  ///< when it was saved first
  std::int64_t saved_utc_s = 0;
  std::uint64_t saves = 0;     ///< how often, this one included
  std::optional<Datum> datum;  ///< in force at the save; the configuration's goes before it
  MapMethod method;
  bool frozen = false;  ///< a sensor that loads it only localises in it, until it is told to unfreeze
};

/// A map as a file holds it.
struct MapFile {
  MapAbout about;
  std::vector<core::MapLandmark> landmarks;
  std::vector<core::Point2> positions_W;
  std::vector<core::PathPose> path;
  core::MapState numbers;  ///< its spans are empty

  /// For Slam::restore; valid as long as this object lives unchanged.
  [[nodiscard]] core::MapState state() const;
};

/// The height of a datum, m: that of the setting datum.height_m.
inline constexpr double kDatumHeightMin_m = -1000.0;
inline constexpr double kDatumHeightMax_m = 10'000.0;

/// Whether the four numbers of `datum` can be those of a place on the earth: latitude, longitude and height
/// as in the settings, the bearing within a turn in either direction.
[[nodiscard]] bool is_on_earth(const Datum& datum) noexcept;

/// Why bytes are not taken for a map.
enum class MapProblem : std::uint8_t {
  Foreign,   ///< something else, or nothing
  TooNew,    ///< of a version that this program does not know
  Damaged,   ///< cut, or a checksum or length that does not hold
  Flawed,    ///< whole, but not a map that the method can have made
  TooLarge,  ///< a good map that the configured capacities have no room for
};

struct MapFileError {
  MapProblem problem = MapProblem::Foreign;
  std::string message;  ///< where in the file, what, and what to do; without the name of the file
};

/// The bytes of a map file. `about.name` has at most 64 characters.
[[nodiscard]] std::vector<std::uint8_t> encode_map(const MapAbout& about, const core::MapState& state);

/// The map that `bytes` hold, without a flaw (core::check_map) and within `capacities`. Takes memory in
/// proportion to bytes.size(), whatever they say.
[[nodiscard]] tl::expected<MapFile, MapFileError> decode_map(std::span<const std::uint8_t> bytes,
                                                             const core::Capacities& capacities);

/// Capacities that any map fits in.
[[nodiscard]] core::Capacities unlimited_capacities();

/// What makes `state` unusable, in words, and what to do; empty when `check` found nothing.
[[nodiscard]] std::string flaw_text(const core::MapCheck& check, const core::MapState& state,
                                    const core::Capacities& capacities);

/// The format of map files. All numbers are little-endian, reals are IEEE 754 binary64, angles rad, lengths
/// m.
///
/// Prefix, the same in every version:
///   8   magic
///   4   version of the format
///   4   number of sections
///   8   size of the whole file
///   4   CRC-32 of the 24 bytes before
/// Then the sections, in the order of MapSection:
///   4   tag
///   4   number of records
///   4   bytes of a record
///   4   CRC-32 of the 12 bytes before and of the records
///   records
/// INFO (one record)  saves u64, created and saved i64 (s since 1970 UTC), weight u64, evicted
///                    u64, thinnings u64, next id u32, scans u32, tolerance, range step, bearing step f64,
///                    depth u32, landmarks_max u32, flags u8 (1 it has a datum, 2 it is marked frozen, 4 it
///                    is a survey, which is frozen too), the datum if it has one (latitude, longitude deg,
///                    height m, bearing deg f64), name (length u16, characters)
/// LAND (a landmark)  id, xi, parents (3), sightings, chances, first and last scan u32, x, y f64, sigma f32,
///                    size: ln diameter, sightings f32 (not before version 5)
/// PATH (a pose)      scan u32, xi u32, x, y, heading f64
/// RATE (none or one) what was learned with the map: the numbers of core::Rates in the order of
///                    visit_numbers, each as it is there, f64 or f32; before version 5 without the last two.
///                    Version 3 has no such section.
///
/// The magic begins with a byte that no text begins with and shows a transfer in text mode, as PNG's does.
inline constexpr std::array<std::uint8_t, 8> kMapMagic{0x89, 'S', 'L', 'M', '\r', '\n', 0x1A, '\n'};
inline constexpr std::uint32_t kMapVersion = 5;
inline constexpr std::uint32_t kMapVersionOldest = 3;  ///< that is read
inline constexpr std::uint32_t kMapVersionSizes = 5;   ///< the first with sizes of landmarks
inline constexpr std::size_t kMapPrefixBytes = 28;
inline constexpr std::size_t kSectionHeadBytes = 16;

/// Larger files are not read: a million landmarks and poses take 88 MB.
inline constexpr std::size_t kMapFileBytesMax = std::size_t{256} << 20;

inline constexpr std::size_t kMapNameMax = 64;

/// Flags of INFO.
inline constexpr std::uint8_t kInfoHasDatum = 1;
inline constexpr std::uint8_t kInfoFrozen = 2;
inline constexpr std::uint8_t kInfoSurveyed = 4;

enum class MapSection : std::uint8_t { Info, Landmarks, Path, Rates };
inline constexpr std::array<std::string_view, 4> kMapSectionTags{"INFO", "LAND", "PATH", "RATE"};

[[nodiscard]] constexpr std::uint32_t sections_of(std::uint32_t version) noexcept {
  return version == kMapVersionOldest ? 3 : kMapSectionTags.size();
}
[[nodiscard]] constexpr std::uint32_t records_max_of(MapSection section) noexcept {
  return section == MapSection::Info || section == MapSection::Rates ? 1 : UINT32_MAX;
}

/// Bytes of a record; 0: it says so itself.
[[nodiscard]] constexpr std::uint32_t record_bytes_of(MapSection section,
                                                      std::uint32_t version = kMapVersion) noexcept {
  const bool has_sizes = version >= kMapVersionSizes;
  switch (section) {
    case MapSection::Landmarks:
      return has_sizes ? 64 : 56;
    case MapSection::Path:
      return 32;
    case MapSection::Rates:
      return 8 * (core::Rates::kDoubles - (has_sizes ? 0 : 2)) + 4 * core::Rates::kFloats;
    case MapSection::Info:
      break;
  }
  return 0;
}

/// CRC-32 (ISO 3309, ITU-T V.42, that of zlib): "123456789" gives 0xCBF43926.
[[nodiscard]] std::uint32_t crc32_of(std::span<const std::uint8_t> first,
                                     std::span<const std::uint8_t> second = {});

/// A section whose head, length and checksum are sound.
struct MapFrameSection {
  std::uint32_t records = 0;
  std::uint32_t record_bytes = 0;
  std::size_t begin = 0;                  ///< of the payload, in the file
  std::span<const std::uint8_t> payload;  ///< records * record_bytes of them
};

/// A map file taken apart; the payloads point into its bytes.
struct MapFrame {
  std::array<MapFrameSection, kMapSectionTags.size()> sections;  ///< by MapSection
};

/// The sections of `bytes`, each of the length and with the checksum that it claims, and nothing beside them.
/// Takes no memory but for a message.
[[nodiscard]] tl::expected<MapFrame, MapFileError> read_frame(std::span<const std::uint8_t> bytes);

/// The error that byte `byte` of a file is damaged.
[[nodiscard]] tl::unexpected<MapFileError> damaged(std::size_t byte, const std::string& what);

}  // namespace slamsensor::firmware
