#pragma once

#include "hal/rangefinder/rangefinder.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::hal {

/// CRC-16/XMODEM: polynomial 0x1021, start 0, nothing reflected, no final XOR; "123456789" gives 0x31C3.
[[nodiscard]] constexpr std::uint16_t crc16_xmodem(std::span<const std::uint8_t> bytes) noexcept {
  constexpr auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t value = i << 8;
      for (int bit = 0; bit < 8; ++bit) {
        value = (value << 1) ^ ((value & 0x8000u) != 0 ? 0x1021u : 0u);
      }
      table[i] = static_cast<std::uint16_t>(value);
    }
    return table;
  }();
  std::uint16_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>((crc << 8) ^ kTable[((crc >> 8) ^ byte) & 0xFFu]);
  }
  return crc;
}

/// The framing of LightWare's binary protocol LWNX (LW20 serial manual): AA, flags with the payload's length
/// in bits 15 to 6 and "write" in bit 0, the command's number and its data (the payload), CRC-16/XMODEM of
/// all that, little-endian throughout.
inline constexpr std::uint8_t kLwnxStart = 0xAA;
inline constexpr std::size_t kLwnxPayloadMax = 1023;  ///< number and data
inline constexpr std::size_t kLwnxOverhead = 5;       ///< start, flags, CRC
inline constexpr std::size_t kLwnxPacketMax = kLwnxPayloadMax + kLwnxOverhead;

struct LwnxPacket {
  std::uint8_t id = 0;
  std::span<const std::uint8_t> data;  ///< lives until the parser is touched again
  std::uint64_t begin = 0;             ///< places in the stream of bytes, from 0
  std::uint64_t end = 0;
};

enum class LwnxAccess : std::uint8_t { Read, Write };

/// Writes the packet into `into`; its size, or 0 when it has no room there or is too long.
[[nodiscard]] std::size_t write_lwnx(std::uint8_t id, LwnxAccess access, std::span<const std::uint8_t> data,
                                     std::span<std::uint8_t> into) noexcept;

/// Finds packets in a stream of bytes. A header that turns out to be none costs no packet behind it: the
/// bytes are looked at again from the next one on.
class LwnxParser {
 public:
  explicit LwnxParser(RangeCounters& counters) noexcept : counters_(counters) {}

  /// Takes the next byte of the stream; call next() until it has nothing more.
  void push(std::uint8_t byte) noexcept;
  [[nodiscard]] std::optional<LwnxPacket> next() noexcept;

  /// Nothing more belongs to the packet under way: what came after its first byte is looked at again.
  void give_up() noexcept;
  [[nodiscard]] bool is_in_packet() const noexcept { return size_ > used_; }

 private:
  enum class Look : std::uint8_t { Packet, Incomplete, Nothing };
  [[nodiscard]] Look look(std::span<const std::uint8_t> bytes, std::size_t& size) noexcept;
  void drop(std::size_t count) noexcept;

  RangeCounters& counters_;
  std::array<std::uint8_t, kLwnxPacketMax> bytes_{};
  std::size_t size_ = 0;
  std::size_t used_ = 0;        ///< bytes of the packet last handed out
  std::uint64_t position_ = 0;  ///< in the stream, of the byte that comes next
};

}  // namespace slamsensor::hal
