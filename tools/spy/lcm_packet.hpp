#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::tools {

/// Longest message that is put together from fragments; larger ones are refused.
inline constexpr std::size_t kLcmMessageMax = 4U << 20U;

/// One datagram of LCM (LCM UDP multicast protocol): a whole message, or a fragment of one.
struct LcmPacket {
  std::uint32_t sequence = 0;
  std::string_view channel;  ///< 1 to 63 characters; empty in all fragments but the first
  std::span<const std::uint8_t> data;
  std::uint32_t message_bytes = 0;  ///< of the whole message
  std::uint32_t offset = 0;    ///< of `data` in it; offset + size of data <= message_bytes <= kLcmMessageMax
  std::uint16_t fragment = 0;  ///< below `fragments`
  std::uint16_t fragments = 1;
};

/// The packet in `datagram`, with views into it; none when its bytes are not one or its numbers disagree.
[[nodiscard]] std::optional<LcmPacket> parse_lcm_packet(std::span<const std::uint8_t> datagram) noexcept;

}  // namespace slamsensor::tools
