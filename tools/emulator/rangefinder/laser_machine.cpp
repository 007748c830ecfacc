#include "tools/emulator/rangefinder/laser_machine.hpp"

#include <algorithm>

namespace slamsensor::tools {

Stamp LaserMachine::next_event() const {
  return power.is_up() ? std::min({timer.next(), outbox.next(), restart_at}) : power.next();
}

bool LaserMachine::takes_shot(Stamp now) {
  if (timer.next() > now) {
    return false;
  }
  timer.advance();
  return true;
}

void LaserMachine::release(Stamp now) {
  outbox.release(now, faults.is_open(FaultKind::Silence, now) ? Outbox::Voice::Silent : Outbox::Voice::On);
}

void LaserMachine::go_down(Stamp until) {
  power.cut(until);
  outbox.clear();
  timer.stop();
  restart_at = hal::kNever;
}

bool LaserMachine::open(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::Silence:
    case FaultKind::NoReturns:
    case FaultKind::WeakSignal:
    case FaultKind::Saturation:
      faults.open(fault);
      return true;
    default:
      return false;
  }
}

}  // namespace slamsensor::tools
