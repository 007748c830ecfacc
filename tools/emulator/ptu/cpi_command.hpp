#pragma once

#include "tools/emulator/ptu/ptu_unit.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::tools {

/// Bytes below are ASCII.
inline constexpr std::uint8_t kCpiOpcodeMin = 129;

// Bytes that the unit puts between its answers.
inline constexpr std::uint8_t kCpiPanLimitHit = 220;
inline constexpr std::uint8_t kCpiTiltLimitHit = 221;

/// How many bytes follow `opcode`; 0 for those that the unit does not know.
[[nodiscard]] std::size_t cpi_argument_size(std::uint8_t opcode, PtuSeries series);

/// Obeys a complete command of the binary interface (C Programmer's Interface, opcodes of the old public
/// headers): opcode and argument, numbers with the high byte first. A D46 does not know the later opcodes.
[[nodiscard]] PtuAnswer obey_cpi(PtuUnit& unit, std::span<const std::uint8_t> command, Stamp now);

}  // namespace slamsensor::tools
