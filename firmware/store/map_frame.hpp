#pragma once

#include "firmware/store/map_file.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
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
/// LAND (a landmark)  id, xi, parents (3), sightings, chances, first and last scan u32, x, y f64, sigma f32
/// PATH (a pose)      scan u32, xi u32, x, y, heading f64
///
/// The magic begins with a byte that no text begins with and shows a transfer in text mode, as PNG's does.
inline constexpr std::array<std::uint8_t, 8> kMapMagic{0x89, 'S', 'L', 'M', '\r', '\n', 0x1A, '\n'};
inline constexpr std::uint32_t kMapVersion = 3;
inline constexpr std::size_t kMapPrefixBytes = 28;
inline constexpr std::size_t kSectionHeadBytes = 16;

/// Larger files are not read: a million landmarks and poses take 88 MB.
inline constexpr std::size_t kMapFileBytesMax = std::size_t{256} << 20;

inline constexpr std::size_t kMapNameMax = 64;

/// Flags of INFO.
inline constexpr std::uint8_t kInfoHasDatum = 1;
inline constexpr std::uint8_t kInfoFrozen = 2;
inline constexpr std::uint8_t kInfoSurveyed = 4;

enum class MapSection : std::uint8_t { Info, Landmarks, Path };
inline constexpr std::array<std::string_view, 3> kMapSectionTags{"INFO", "LAND", "PATH"};

/// Bytes of a record; 0: it says so itself.
[[nodiscard]] constexpr std::uint32_t record_bytes_of(MapSection section) noexcept {
  switch (section) {
    case MapSection::Landmarks:
      return 56;
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
