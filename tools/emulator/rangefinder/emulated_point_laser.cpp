#include "tools/emulator/rangefinder/emulated_point_laser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace slamsensor::tools {
namespace {

constexpr std::uint32_t kFactoryBaud = 115'200;
constexpr std::uint8_t kEscape = 0x1B;
constexpr std::size_t kLineMax = 80;

/// `value` with `decimals` digits behind the point and at least `width` characters, zeros in front.
std::string fixed_text(double value, int decimals, int width = 0) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%0*.*f", width, decimals, value);
  return text.data();
}

std::string text_record(const PointFormat& format, const PointReading& reading) {
  if (reading.kind != PointReading::Kind::Distance) {
    return (reading.kind == PointReading::Kind::Error ? format.error : format.no_return) + "\r\n";
  }
  std::string text =
      format.prefix + fixed_text(reading.range_m, format.decimals, format.digits + 1 + format.decimals);
  if (format.extras == PointExtras::Quality) {
    text += " " + fixed_text(std::round(reading.quality), 0, 4);
  }
  return text + "\r\n";
}

}  // namespace

void build_point_record(const PointFormat& format, const PointReading& reading,
                        std::vector<std::uint8_t>& out) {
  if (format.coding == PointCoding::Decimal) {
    const std::string text = text_record(format, reading);
    out.assign(text.begin(), text.end());
    return;
  }
  constexpr double kHighest = 16'383.0;
  const double units = std::round(reading.range_m * format.units_per_m);
  const bool is_told = reading.kind == PointReading::Kind::Distance && units >= 0.0 && units <= kHighest;
  const unsigned number = is_told ? static_cast<unsigned>(units) : 0U;
  out = {static_cast<std::uint8_t>(0x80U | number >> 7U), static_cast<std::uint8_t>(number & 0x7FU)};
}

std::size_t point_record_bytes(const PointFormat& format) {
  std::vector<std::uint8_t> record;
  build_point_record(format, {.kind = PointReading::Kind::Distance, .range_m = 1.0}, record);
  return record.size();
}

PointSettings lds70a_settings() {
  PointSettings settings;
  settings.dialect = PointDialect::Lds70a;
  settings.format.prefix = "D";
  return settings;
}

PointSettings laserace_im_settings() {
  PointSettings settings;
  settings.format.digits = 3;
  settings.format.decimals = 1;
  settings.format.no_return = "000.0";
  settings.format.error = "E01";
  settings.identity = "LaserAce IM HR (unverified)";
  return settings;
}

PointCommands::PointCommands(const PointSettings& settings) : settings_(settings), format_(settings.format) {
}

PointAnswer PointCommands::run(std::string_view line) {
  if (line == "DT") {
    return {"", PointAction::Track};
  }
  if (line != "SD 0 0" && line != "SD 0 1") {
    return {"?\r\n", PointAction::None};
  }
  format_.coding = PointCoding::Decimal;
  format_.extras = line.back() == '0' ? PointExtras::None : PointExtras::Quality;
  return {std::string(line) + "\r\n", PointAction::None};
}

double PointCommands::rate_hz(std::uint32_t baud) const {
  const double carried_hz = baud / (10.0 * static_cast<double>(point_record_bytes(format_)));
  return settings_.dialect == PointDialect::None ? settings_.rate_hz
                                                 : std::min(settings_.rate_hz, carried_hz);
}

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
}

void EmulatedPointLaser::start_up(Stamp now) {
  machine_.power.go_up();
  text_.clear();
  track(now);
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
    machine_.timer.stop();
  } else if (byte == '\r') {
    const std::string line = std::move(text_);
    text_.clear();
    if (!line.empty()) {
      machine_.timer.stop();
      take_line(line, at);
    }
  } else if (byte != '\n' && text_.size() < kLineMax) {
    text_.push_back(static_cast<char>(byte));
  }
}

void EmulatedPointLaser::take_line(std::string_view line, Stamp at) {
  const PointAnswer answer = commands_.run(line);
  if (!answer.text.empty()) {
    put_text(answer.text, at);
  }
  if (answer.action == PointAction::Track) {
    track(at);
  }
}

void EmulatedPointLaser::track(Stamp at) {
  machine_.timer.start_after(at, commands_.rate_hz(line_.baud()));
}

void EmulatedPointLaser::put_text(std::string_view text, Stamp at) {
  machine_.outbox.put_answer(std::vector<std::uint8_t>(text.begin(), text.end()), at);
}

void EmulatedPointLaser::build_record(Stamp at) {
  build_point_record(commands_.format(), read(look(scene_, at, machine_.faults)), record_);
}

PointReading EmulatedPointLaser::read(const Sight& sight) const {
  if (sight.kind == SightKind::Error) {
    return {.kind = PointReading::Kind::Error};
  }
  const bool is_odd = sight.kind == SightKind::Weak || sight.kind == SightKind::Saturated;
  if (!sight.has_echo() || (is_odd && commands_.format().extras != PointExtras::Quality)) {
    return {};
  }
  PointReading reading{
      .kind = PointReading::Kind::Distance, .range_m = sight.range_m, .quality = settings_.quality.of(sight)};
  if (is_odd) {
    reading.quality =
        sight.kind == SightKind::Weak ? settings_.quality_of_weak : settings_.quality_of_blinded;
  }
  return reading;
}

bool EmulatedPointLaser::inject(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::PowerCycle:
      go_down(fault.at + fault.duration);
      return true;
    case FaultKind::BaudReset:
      line_.set_baud(kFactoryBaud);
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
