#pragma once

#include "hal/transport/can_link.hpp"

#include <cstdint>
#include <initializer_list>
#include <ostream>

namespace slamsensor::hal {

/// For the messages of failed assertions: "123#0102" or "1fffffff!#" (extended).
inline void PrintTo(const CanFrame& frame, std::ostream* out) {
  *out << std::hex << frame.id << (frame.extended ? "!#" : "#");
  for (const std::uint8_t byte : frame.bytes()) {
    *out << (byte >> 4U) << (byte & 15U);
  }
  *out << std::dec;
}

}  // namespace slamsensor::hal

namespace slamsensor::tests {

inline hal::CanFrame make_frame(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  hal::CanFrame frame;
  frame.id = id;
  for (const std::uint8_t byte : data) {
    frame.data.at(frame.size++) = byte;
  }
  return frame;
}

inline hal::CanFrame make_extended(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  hal::CanFrame frame = make_frame(id, data);
  frame.extended = true;
  return frame;
}

}  // namespace slamsensor::tests
