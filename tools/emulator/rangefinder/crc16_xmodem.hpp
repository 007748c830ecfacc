#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace slamsensor::tools {

/// CRC-16/XMODEM (polynomial 0x1021, start 0, nothing reflected or inverted): 0x31C3 for "123456789".
[[nodiscard]] constexpr std::uint16_t crc16_xmodem(std::span<const std::uint8_t> bytes) {
  constexpr auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (unsigned high = 0; high < table.size(); ++high) {
      unsigned remainder = high << 8U;
      for (int bit = 0; bit < 8; ++bit) {
        remainder = (remainder << 1U) ^ ((remainder & 0x8000U) != 0U ? 0x1021U : 0U);
      }
      table[high] = static_cast<std::uint16_t>(remainder);
    }
    return table;
  }();
  std::uint16_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    const auto index = static_cast<std::uint8_t>((crc >> 8U) ^ byte);
    crc = static_cast<std::uint16_t>((crc << 8U) ^ kTable[index]);
  }
  return crc;
}

}  // namespace slamsensor::tools
