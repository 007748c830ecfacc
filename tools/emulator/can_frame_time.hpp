#pragma once

#include "hal/transport/can_link.hpp"

#include <cstddef>
#include <cstdint>

namespace slamsensor::tools {

/// Bits that a classical data frame takes on the bus, stuff bits and the intermission of 3 bits included
/// (ISO 11898-1: a bit of opposite level after five equal ones, from start of frame to the checksum's end).
[[nodiscard]] std::size_t can_frame_bits(const hal::CanFrame& frame);

/// The same as a length of time at `bitrate` bit/s (positive), rounded down to the nanosecond.
[[nodiscard]] hal::Stamp can_frame_time(const hal::CanFrame& frame, std::uint32_t bitrate);

/// What decides which of two frames goes first when both want the bus: the smaller one. A base frame goes
/// before an extended one with the same first 11 bits.
[[nodiscard]] std::uint32_t arbitration_key(const hal::CanFrame& frame) noexcept;

}  // namespace slamsensor::tools
