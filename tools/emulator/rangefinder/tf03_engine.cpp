#include "tools/emulator/rangefinder/tf03_engine.hpp"

namespace slamsensor::tools {

Tf03Engine::Tf03Engine(const Tf03Settings& settings, Tf03Wire wire, OutboxLine& line, RangeScene& scene)
    : settings_(settings), wire_(wire), scene_(scene), machine_(settings, line, scene), commands_(settings) {
  if (machine_.power.is_up()) {
    start_up(Stamp::zero());
  }
}

void Tf03Engine::step(Stamp now) {
  if (!machine_.power.is_up()) {
    start_up(now);
    return;
  }
  if (machine_.takes_shot(now) && active().output == Tf03Switch::On) {
    shoot(now);
  }
  machine_.release(now);
  if (machine_.restart_at <= now) {
    go_down(now);
  }
}

void Tf03Engine::start_up(Stamp now) {
  machine_.power.go_up();
  ++power_changes_;
  commands_.start_up();
  receiver_.clear();
  retime(now);
}

void Tf03Engine::go_down(Stamp until) {
  machine_.go_down(until);
  ++power_changes_;
}

void Tf03Engine::retime(Stamp now) {
  if (active().rate_hz == 0 || !hears()) {
    machine_.timer.stop();
  } else {
    machine_.timer.start_after(now, active().rate_hz);
  }
}

void Tf03Engine::shoot(Stamp at) {
  const Sight sight = look(scene_, at, machine_.faults);
  const Tf03Words words = tf03_words(settings_, active(), sight);
  if (wire_ == Tf03Wire::Can) {
    build_tf03_can(settings_, words, frame_);
  } else if (active().format == Tf03Format::Text) {
    build_tf03_text(words, frame_);
  } else {
    build_tf03_frame(settings_, words, frame_);
    if (machine_.faults.take(FaultKind::BadChecksum)) {
      frame_.back() ^= 0x5AU;
    }
  }
  machine_.outbox.put_record(frame_, {&at, 1}, at);
}

void Tf03Engine::receive(std::uint8_t byte, Stamp at) {
  if (!hears()) {
    return;
  }
  if (const auto command = receiver_.push(byte, at, active().checks_sums)) {
    run(*command, at);
  }
}

void Tf03Engine::run(std::span<const std::uint8_t> command, Stamp at) {
  const auto answer = commands_.run(command);
  if (!answer) {
    ++refused_;
    return;
  }
  if (!answer->bytes.empty()) {
    machine_.outbox.put_answer(answer->bytes, at);
  }
  switch (answer->action) {
    case Tf03Action::Restart:
      machine_.restart_at = at + settings_.restart_delay;
      break;
    case Tf03Action::Trigger:
      shoot(at);
      break;
    case Tf03Action::Retime:
      retime(at);
      break;
    case Tf03Action::None:
      break;
  }
}

bool Tf03Engine::inject(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::PowerCycle:
      go_down(fault.at + fault.duration);
      return true;
    case FaultKind::StreamStops:
      commands_.stop_output();
      return true;
    case FaultKind::DeviceError:
      if (settings_.model != BenewakeModel::TfMiniS) {
        return false;
      }
      machine_.faults.open(fault);
      return true;
    default:
      return machine_.open(fault);
  }
}

void Tf03Engine::put_text(std::string_view text, Stamp at) {
  if (hears()) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    machine_.outbox.put_answer(bytes, at);
  }
}

}  // namespace slamsensor::tools
