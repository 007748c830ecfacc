#include "tools/emulator/rangefinder/tf03_engine.hpp"

#include <algorithm>

namespace slamsensor::tools {

Tf03Engine::Tf03Engine(const Tf03Settings& settings, Tf03Wire wire, OutboxLine& line, RangeScene& scene)
    : settings_(settings),
      wire_(wire),
      scene_(scene),
      outbox_(line, scene, settings.delays, settings.seed),
      commands_(settings),
      power_(settings.begin, settings.boot_time),
      timer_(settings.crystal_ppm) {
  if (power_.is_up()) {
    start_up(Stamp::zero());
  }
}

Stamp Tf03Engine::next_event() const {
  if (!power_.is_up()) {
    return power_.next();
  }
  return std::min({timer_.next(), outbox_.next(), restart_at_});
}

void Tf03Engine::step(Stamp now) {
  if (!power_.is_up()) {
    start_up(now);
    return;
  }
  if (timer_.next() <= now) {
    timer_.advance();
    if (active().output == Tf03Switch::On) {
      shoot(now);
    }
  }
  outbox_.release(now, faults_.is_open(FaultKind::Silence, now) ? Outbox::Voice::Silent : Outbox::Voice::On);
  if (restart_at_ <= now) {
    go_down(now);
  }
}

void Tf03Engine::start_up(Stamp now) {
  power_.go_up();
  ++power_changes_;
  commands_.start_up();
  receiver_.clear();
  retime(now);
}

void Tf03Engine::go_down(Stamp until) {
  power_.cut(until);
  ++power_changes_;
  outbox_.clear();
  timer_.stop();
  restart_at_ = hal::kNever;
}

void Tf03Engine::retime(Stamp now) {
  if (active().rate_hz == 0 || !hears()) {
    timer_.stop();
  } else {
    timer_.start_after(now, active().rate_hz);
  }
}

void Tf03Engine::shoot(Stamp at) {
  const Sight sight = look(scene_, at, faults_);
  const Tf03Words words = tf03_words(settings_, active(), sight);
  if (wire_ == Tf03Wire::Can) {
    build_tf03_can(settings_, words, frame_);
  } else if (active().format == Tf03Format::Text) {
    build_tf03_text(words, frame_);
  } else {
    build_tf03_frame(settings_, words, frame_);
    if (faults_.take(FaultKind::BadChecksum)) {
      frame_.back() ^= 0x5AU;
    }
  }
  outbox_.put_record(frame_, {&at, 1}, at);
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
    outbox_.put_answer(answer->bytes, at);
  }
  switch (answer->action) {
    case Tf03Action::Restart:
      restart_at_ = at + settings_.restart_delay;
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
      faults_.open(fault);
      return true;
    case FaultKind::Silence:
    case FaultKind::NoReturns:
    case FaultKind::WeakSignal:
    case FaultKind::Saturation:
      faults_.open(fault);
      return true;
    default:
      return false;
  }
}

void Tf03Engine::put_text(std::string_view text, Stamp at) {
  if (hears()) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    outbox_.put_answer(bytes, at);
  }
}

}  // namespace slamsensor::tools
