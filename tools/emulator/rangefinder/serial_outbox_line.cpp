#include "tools/emulator/rangefinder/serial_outbox_line.hpp"

#include <algorithm>

namespace slamsensor::tools {

std::optional<Stamp> SerialOutboxLine::put(std::span<const std::uint8_t> bytes, Stamp at, Urgency urgency) {
  const Stamp begin = std::max(at, sink_.busy_until());
  // What is still in the buffer takes until `begin` to leave it.
  const Stamp room_after = begin - at + hal::line_time(bytes.size(), baud_);
  if (urgency == Urgency::Record && begin > at && room_after > hal::line_time(buffer_bytes_, baud_)) {
    return std::nullopt;
  }
  sink_.send(bytes, at);
  return begin;
}

}  // namespace slamsensor::tools
