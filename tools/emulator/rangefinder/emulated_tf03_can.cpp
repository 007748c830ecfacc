#include "tools/emulator/rangefinder/emulated_tf03_can.hpp"

#include <algorithm>

namespace slamsensor::tools {

void EmulatedTf03Can::Line::follow(const Tf03Parameters& parameters, bool is_on_bus) {
  id_ = parameters.can_send_id;
  extended_ = parameters.can_extended == Tf03Switch::On;
  is_on_bus_ = is_on_bus;
}

std::optional<Stamp> EmulatedTf03Can::Line::put(std::span<const std::uint8_t> bytes, Stamp at,
                                                Urgency /*urgency*/) {
  if (!is_on_bus_) {
    return std::nullopt;
  }
  for (std::size_t begin = 0; begin < bytes.size(); begin += 8) {
    const auto part = bytes.subspan(begin, std::min<std::size_t>(8, bytes.size() - begin));
    hal::CanFrame frame{.id = id_, .extended = extended_, .size = static_cast<std::uint8_t>(part.size())};
    std::ranges::copy(part, frame.data.begin());
    sink_.send(frame, at);
  }
  return at;
}

EmulatedTf03Can::EmulatedTf03Can(const Tf03Settings& settings, FrameSink& sink, RangeScene& scene)
    : settings_(settings), line_(sink), engine_(settings_, Tf03Wire::Can, line_, scene) {
  follow_engine();
}

void EmulatedTf03Can::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    engine_.step(event);
    follow_engine();
  }
}

void EmulatedTf03Can::receive(const hal::CanFrame& frame, Stamp at) {
  if (settings_.can_commands == Tf03Switch::Off || !is_on_bus() ||
      frame.id != engine_.active().can_receive_id) {
    return;
  }
  for (const std::uint8_t byte : frame.bytes()) {
    engine_.receive(byte, at);
  }
  follow_engine();
}

void EmulatedTf03Can::follow_engine() {
  line_.follow(engine_.active(), is_on_bus());
}

}  // namespace slamsensor::tools
