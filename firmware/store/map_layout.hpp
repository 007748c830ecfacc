#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

/// The format of map files. All numbers are little-endian, reals are IEEE 754 binary64, angles rad, lengths
/// m.
///
/// Prefix, the same in every version:
///   8   magic
///   4   version of the format
///   4   number of sections
///   8   size of the whole file
///   4   CRC-32 of the 24 bytes before
/// Then the sections, in the order of kMapSections without what a version does not have:
///   4   tag
///   4   number of records
///   4   bytes of a record
///   4   CRC-32 of the 12 bytes before and of the records
///   records
/// INFO (one record)  version 2: saves u64, created and saved i64 (s since 1970 UTC), weight u64, evicted
///                    u64, thinnings u64, next id u32, scans u32, tolerance, range step, bearing step f64,
///                    depth u32, landmarks_max u32, has datum u8 (then latitude, longitude deg, height m,
///                    bearing deg f64), name (length u16, characters)
///                    version 1: saved i64, weight u64, next id u32, scans u32, name
///                    version 3: as version 2 of a map marked frozen; has datum u8 is 2 without and 3 with
///                    one
/// LAND (a landmark)  id, xi, parents (3), sightings, chances, first and last scan u32, x, y f64
///                    version 1: without chances
/// PATH (a pose)      scan u32, xi u32, x, y, heading f64; not in version 1
///
/// The magic begins with a byte that no text begins with and shows a transfer in text mode, as PNG's does.
inline constexpr std::array<std::uint8_t, 8> kMapMagic{0x89, 'S', 'L', 'M', '\r', '\n', 0x1A, '\n'};
inline constexpr std::uint32_t kMapVersion = 2;        ///< of an ordinary map
inline constexpr std::uint32_t kMapVersionFrozen = 3;  ///< of a map marked frozen
inline constexpr std::uint32_t kMapVersionNewest = 3;
inline constexpr std::uint32_t kMapVersionOldest = 1;
inline constexpr std::size_t kMapPrefixBytes = 28;
inline constexpr std::size_t kSectionHeadBytes = 16;

/// Larger files are not read: a million landmarks and poses take 84 MB.
inline constexpr std::size_t kMapFileBytesMax = std::size_t{256} << 20;

inline constexpr std::size_t kMapNameMax = 64;

/// Bits of the byte `has datum` of INFO.
inline constexpr std::uint8_t kInfoHasDatum = 1;
inline constexpr std::uint8_t kInfoFrozen = 2;  ///< always in version 3, never in version 2

enum class MapSection : std::uint8_t { Info, Landmarks, Path };
inline constexpr std::array<std::string_view, 3> kMapSectionTags{"INFO", "LAND", "PATH"};

[[nodiscard]] constexpr std::uint32_t sections_of(std::uint32_t version) noexcept {
  return version == 1 ? 2 : 3;
}

/// Bytes of a record; 0: it says so itself.
[[nodiscard]] constexpr std::uint32_t record_bytes_of(MapSection section, std::uint32_t version) noexcept {
  switch (section) {
    case MapSection::Landmarks:
      return version == 1 ? 48 : 52;
    case MapSection::Path:
      return 32;
    case MapSection::Info:
      break;
  }
  return 0;
}

/// CRC-32 (ISO 3309, ITU-T V.42, that of zlib): "123456789" gives 0xCBF43926.
[[nodiscard]] std::uint32_t crc32_of(std::span<const std::uint8_t> first,
                                     std::span<const std::uint8_t> second = {});

}  // namespace slamsensor::firmware
