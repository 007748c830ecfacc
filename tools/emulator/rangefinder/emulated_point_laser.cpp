#include "tools/emulator/rangefinder/emulated_point_laser.hpp"

namespace slamsensor::tools {
namespace {

constexpr std::uint8_t kEscape = 0x1B;
constexpr std::size_t kLineMax = 80;

}  // namespace

EmulatedPointLaser::EmulatedPointLaser(const PointSettings& settings, ByteSink& sink, RangeScene& scene)
    : settings_(settings),
      scene_(scene),
      line_(sink, settings.transmit_buffer_bytes),
      machine_(settings, line_, scene),
      commands_(settings_) {
  line_.set_baud(settings.baud);
  if (machine_.power.is_up()) {
    start_up(Stamp::zero());
  }
}

void EmulatedPointLaser::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    step(event);
  }
}

void EmulatedPointLaser::step(Stamp now) {
  if (!machine_.power.is_up()) {
    start_up(now);
    return;
  }
  if (machine_.takes_shot(now)) {
    build_record(now);
    machine_.outbox.put_record(record_, {&now, 1}, now);
  }
  machine_.release(now);
  follow_baud();
  if (machine_.restart_at <= now) {
    go_down(now);
  }
}

void EmulatedPointLaser::start_up(Stamp now) {
  machine_.power.go_up();
  text_.clear();
  last_ = {};
  line_.set_baud(commands_.baud());
  if (settings_.dialect == PointDialect::None) {
    act(PointAction::Track, now);
  } else {
    take_line(std::string(commands_.autostart()), now);
  }
}

void EmulatedPointLaser::go_down(Stamp until) {
  machine_.go_down(until);
  line_.clear();
}

void EmulatedPointLaser::receive(std::uint8_t byte, Stamp at) {
  if (!machine_.power.is_up() || settings_.dialect == PointDialect::None) {
    return;
  }
  if (byte == kEscape) {
    text_.clear();
    if (settings_.stop != PointStop::Command) {
      act(PointAction::Stop, at);
    }
  } else if (byte == '\r') {
    const std::string line = std::move(text_);
    text_.clear();
    const bool is_deaf = machine_.timer.running() && settings_.stop == PointStop::Escape;
    if (!line.empty() && !is_deaf) {
      act(PointAction::Stop, at);
      take_line(line, at);
    }
  } else if (byte != '\n' && text_.size() < kLineMax) {
    text_.push_back(static_cast<char>(byte));
  }
}

void EmulatedPointLaser::take_line(std::string_view line, Stamp at) {
  if (line.empty()) {
    return;
  }
  const PointAnswer answer = commands_.run(line);
  if (!answer.text.empty()) {
    put_text(answer.text, at);
  }
  act(answer.action, at);
}

void EmulatedPointLaser::act(PointAction action, Stamp at) {
  switch (action) {
    case PointAction::Measure:
      build_record(at);
      machine_.outbox.put_answer(record_, at, {&at, 1});
      break;
    case PointAction::Track:
      machine_.timer.start_after(
          at, settings_.dialect == PointDialect::None ? settings_.rate_hz : commands_.rate_hz());
      break;
    case PointAction::Stop:
      machine_.timer.stop();
      break;
    case PointAction::Restart:
      machine_.restart_at = at;
      break;
    case PointAction::None:
      break;
  }
}

void EmulatedPointLaser::follow_baud() {
  if (!machine_.outbox.has_answers()) {
    line_.set_baud(commands_.baud());
  }
}

void EmulatedPointLaser::put_text(std::string_view text, Stamp at) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  machine_.outbox.put_answer(bytes, at);
}

void EmulatedPointLaser::build_record(Stamp at) {
  const Sight sight = look(scene_, at, machine_.faults);
  commands_.note(sight);
  build_point_record(commands_.format(), read(sight), record_);
}

PointReading EmulatedPointLaser::read(const Sight& sight) {
  using Kind = PointReading::Kind;
  if (sight.kind == SightKind::Error) {
    return {.kind = Kind::Error};
  }
  PointReading reading{.kind = Kind::Distance,
                       .range_m = commands_.with_offset_m(sight.range_m),
                       .quality = settings_.quality.of(sight)};
  const bool is_odd = sight.kind == SightKind::Weak || sight.kind == SightKind::Saturated;
  if (is_odd) {
    reading.quality =
        sight.kind == SightKind::Weak ? settings_.quality_of_weak : settings_.quality_of_blinded;
  }
  const bool is_untold = is_odd && !has_quality(commands_.format().extras);
  const bool has_window = settings_.dialect == PointDialect::Lds70a;
  if (!sight.has_echo() || is_untold || (has_window && !commands_.is_in_window(reading.range_m))) {
    return commands_.repeats_on_error() && last_.kind == Kind::Distance ? last_ : PointReading{};
  }
  last_ = reading;
  return reading;
}

bool EmulatedPointLaser::inject(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::PowerCycle:
      go_down(fault.at + fault.duration);
      return true;
    case FaultKind::BaudReset:
      commands_.set_baud(settings_.factory_baud);
      line_.set_baud(settings_.factory_baud);
      return true;
    case FaultKind::StreamStops:
      if (settings_.dialect == PointDialect::None) {
        return false;  // no command could start it again
      }
      machine_.timer.stop();
      return true;
    case FaultKind::TextMessage:
      if (machine_.power.is_up()) {
        put_text(settings_.identity + "\r\n", fault.at);
      }
      return true;
    case FaultKind::DeviceError:
      machine_.faults.open(fault);
      return true;
    default:
      return machine_.open(fault);
  }
}

}  // namespace slamsensor::tools
