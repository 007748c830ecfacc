#include "tools/spy/lcm_packet.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::uint32_t kShortMagic = 0x4C433032;     // "LC02"
constexpr std::uint32_t kFragmentMagic = 0x4C433033;  // "LC03"
constexpr std::size_t kShortHeader = 8;
constexpr std::size_t kFragmentHeader = 20;
constexpr std::size_t kChannelMax = 63;

/// The big-endian number in `bytes`.
std::uint32_t number(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) {
    value = (value << 8U) | byte;
  }
  return value;
}

/// Takes the channel and its zero off the front of packet.data; false when there is none.
bool take_channel(LcmPacket& packet) noexcept {
  const auto head = packet.data.first(std::min(packet.data.size(), kChannelMax + 1));
  const auto end = std::find(head.begin(), head.end(), std::uint8_t{0});
  const auto size = static_cast<std::size_t>(end - head.begin());
  if (end == head.end() || size == 0) {
    return false;
  }
  packet.channel = {reinterpret_cast<const char*>(head.data()), size};
  packet.data = packet.data.subspan(size + 1);
  return true;
}

std::optional<LcmPacket> parse_short(std::span<const std::uint8_t> datagram) noexcept {
  LcmPacket packet;
  packet.sequence = number(datagram.subspan(4, 4));
  packet.data = datagram.subspan(kShortHeader);
  if (!take_channel(packet)) {
    return std::nullopt;
  }
  packet.message_bytes = static_cast<std::uint32_t>(packet.data.size());
  return packet;
}

std::optional<LcmPacket> parse_fragment(std::span<const std::uint8_t> datagram) noexcept {
  LcmPacket packet;
  packet.sequence = number(datagram.subspan(4, 4));
  packet.message_bytes = number(datagram.subspan(8, 4));
  packet.offset = number(datagram.subspan(12, 4));
  packet.fragment = static_cast<std::uint16_t>(number(datagram.subspan(16, 2)));
  packet.fragments = static_cast<std::uint16_t>(number(datagram.subspan(18, 2)));
  packet.data = datagram.subspan(kFragmentHeader);
  const bool has_channel = packet.fragment > 0 || take_channel(packet);
  const bool fits = packet.message_bytes <= kLcmMessageMax && packet.offset <= packet.message_bytes &&
                    packet.data.size() <= packet.message_bytes - packet.offset;
  if (!has_channel || !fits || packet.data.empty() || packet.fragment >= packet.fragments) {
    return std::nullopt;
  }
  return packet;
}

}  // namespace

std::optional<LcmPacket> parse_lcm_packet(std::span<const std::uint8_t> datagram) noexcept {
  if (datagram.size() < kShortHeader) {
    return std::nullopt;
  }
  const std::uint32_t magic = number(datagram.first(4));
  if (magic == kShortMagic) {
    return parse_short(datagram);
  }
  if (magic == kFragmentMagic && datagram.size() >= kFragmentHeader) {
    return parse_fragment(datagram);
  }
  return std::nullopt;
}

}  // namespace slamsensor::tools
