#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace slamsensor::tests {

using Bytes = std::vector<std::uint8_t>;

inline void append_number(Bytes& out, std::uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

inline void append_text(Bytes& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
}

inline Bytes short_packet(std::uint32_t sequence, std::string_view channel,
                          std::span<const std::uint8_t> data) {
  Bytes out;
  append_text(out, "LC02");
  append_number(out, sequence, 4);
  append_text(out, channel);
  out.push_back(0);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

struct FragmentHead {
  std::uint32_t sequence = 0;
  std::uint32_t total = 0;
  std::uint32_t offset = 0;
  std::uint16_t fragment = 0;
  std::uint16_t fragments = 0;
};

inline Bytes fragment_packet(const FragmentHead& head, std::string_view channel,
                             std::span<const std::uint8_t> data) {
  Bytes out;
  append_text(out, "LC03");
  append_number(out, head.sequence, 4);
  append_number(out, head.total, 4);
  append_number(out, head.offset, 4);
  append_number(out, head.fragment, 2);
  append_number(out, head.fragments, 2);
  if (head.fragment == 0) {
    append_text(out, channel);
    out.push_back(0);
  }
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

/// `message` in pieces of `piece` bytes.
inline std::vector<Bytes> fragments_of(std::uint32_t sequence, std::string_view channel, const Bytes& message,
                                       std::size_t piece) {
  std::vector<Bytes> packets;
  const std::size_t count = (message.size() + piece - 1) / piece;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t offset = i * piece;
    const FragmentHead head{sequence, static_cast<std::uint32_t>(message.size()),
                            static_cast<std::uint32_t>(offset), static_cast<std::uint16_t>(i),
                            static_cast<std::uint16_t>(count)};
    const auto data = std::span(message).subspan(offset, std::min(piece, message.size() - offset));
    packets.push_back(fragment_packet(head, channel, data));
  }
  return packets;
}

}  // namespace slamsensor::tests
