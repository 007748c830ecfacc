#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

}  // namespace slamsensor::hal
