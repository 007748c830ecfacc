#pragma once

#include "firmware/store/map_file.hpp"
#include "firmware/store/map_layout.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace slamsensor::firmware {

/// A section whose head, length and checksum are sound.
struct MapFrameSection {
  std::uint32_t records = 0;
  std::uint32_t record_bytes = 0;
  std::size_t begin = 0;                  ///< of the payload, in the file
  std::span<const std::uint8_t> payload;  ///< records * record_bytes of them
};

/// A map file taken apart; the payloads point into its bytes.
struct MapFrame {
  std::uint32_t version = 0;
  std::array<MapFrameSection, kMapSectionTags.size()> sections;  ///< by MapSection; empty where absent
};

/// The sections of `bytes`, each of the length and with the checksum that it claims, and nothing beside them.
/// Takes no memory but for a message.
[[nodiscard]] tl::expected<MapFrame, MapFileError> read_frame(std::span<const std::uint8_t> bytes);

/// The error that byte `byte` of a file is damaged.
[[nodiscard]] tl::unexpected<MapFileError> damaged(std::size_t byte, const std::string& what);

}  // namespace slamsensor::firmware
