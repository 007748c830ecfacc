#pragma once

#include "firmware/lcm/fingerprint.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// Channels of a recording beside those that the sensor transmits on.
inline constexpr std::string_view kConfigChannel = "SLAMSENSOR_CONFIG";  ///< text_t: TOML of all keys
inline constexpr std::string_view kMapChannel = "SLAMSENSOR_MAP_FILE";   ///< block_t 0: the map at the start
inline constexpr std::string_view kTapeChannel = "SLAMSENSOR_TAPE";      ///< block_t: the tape's chunks
inline constexpr std::string_view kOrderChannel = "SLAMSENSOR_ORDER";    ///< text_t: a MapOrder
inline constexpr std::string_view kNmeaChannel = "SLAMSENSOR_NMEA";      ///< text_t: sentences as sent

/// Of the types in block_t.lcm and text_t.lcm.
inline constexpr std::uint64_t kBlockFingerprint =
    lcm_fingerprint({{"utime", "int64_t", ""},
                     {"number", "int64_t", ""},
                     {"checksum", "int32_t", ""},
                     {"size", "int32_t", ""},
                     {"data", "byte", "size", LcmArray::ByMember}});
inline constexpr std::uint64_t kTextFingerprint =
    lcm_fingerprint({{"utime", "int64_t", ""}, {"checksum", "int32_t", ""}, {"text", "string", ""}});

struct Block {
  std::int64_t utime_us = 0;
  std::int64_t number = 0;
  std::span<const std::uint8_t> data;
};

struct Text {
  std::int64_t utime_us = 0;
  std::string_view text;  ///< no NUL in it
};

/// `out` holds exactly the LCM message, fingerprint included. What is to be sent is shorter than 2^31 bytes.
void encode(const Block& block, std::vector<std::uint8_t>& out);
void encode(const Text& text, std::vector<std::uint8_t>& out);

/// What `message` carries, in place; nothing when it is of another type, its lengths do not fit it exactly or
/// its checksum is wrong.
[[nodiscard]] std::optional<Block> decode_block(std::span<const std::uint8_t> message);
[[nodiscard]] std::optional<Text> decode_text(std::span<const std::uint8_t> message);

}  // namespace slamsensor::firmware
