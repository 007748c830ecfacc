#include "tools/emulator/rangefinder/emulated_tf03.hpp"

namespace slamsensor::tools {

EmulatedTf03::EmulatedTf03(const Tf03Settings& settings, ByteSink& sink, RangeScene& scene)
    : settings_(settings),
      line_(sink, settings.transmit_buffer_bytes),
      engine_(settings_, Tf03Wire::Uart, line_, scene),
      power_changes_(engine_.power_changes()) {
  line_.set_baud(engine_.active().baud);
}

void EmulatedTf03::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    engine_.step(event);
    follow_engine();
  }
}

void EmulatedTf03::receive(std::uint8_t byte, Stamp at) {
  engine_.receive(byte, at);
  follow_engine();
}

void EmulatedTf03::follow_engine() {
  if (power_changes_ != engine_.power_changes()) {
    power_changes_ = engine_.power_changes();
    if (!engine_.is_up()) {
      line_.clear();
    }
  }
  if (!engine_.outbox().has_answers()) {
    line_.set_baud(engine_.active().baud);
  }
}

bool EmulatedTf03::inject(const Fault& fault) {
  bool is_known = true;
  switch (fault.kind) {
    case FaultKind::BaudReset:
      engine_.reset_baud();
      line_.set_baud(engine_.active().baud);
      break;
    case FaultKind::BadChecksum:
      engine_.spoil_next();
      break;
    case FaultKind::TextMessage:
      engine_.put_text("TF03 running\r\n", fault.at);
      break;
    default:
      is_known = engine_.inject(fault);
  }
  follow_engine();
  return is_known;
}

}  // namespace slamsensor::tools
