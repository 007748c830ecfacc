#include "tools/emulator/rangefinder/emulated_point_laser.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

namespace slamsensor::tools {
namespace {

constexpr std::uint32_t kFactoryBaud = 115'200;
constexpr double kTemperature_c = 23.5;
constexpr double kFrequencyMax_hz = 40'000.0;
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
  if (has_quality(format.extras)) {
    text += " " + fixed_text(std::round(reading.quality), 0, 4);
  }
  if (has_temperature(format.extras)) {
    text += " +" + fixed_text(kTemperature_c, 1);
  }
  return text + "\r\n";
}

/// `text` in capitals and without spaces at its ends.
std::string cleaned(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(' '), text.size());
  std::string out(text.substr(begin, text.find_last_not_of(' ') + 1 - begin));
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

/// The numbers in `text`, separated by spaces; nothing when something else stands there.
std::optional<std::vector<double>> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  while (*at != '\0') {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at || !std::isfinite(number)) {
      return std::nullopt;
    }
    numbers.push_back(number);
    at = end;
    while (*at == ' ') {
      ++at;
    }
  }
  return numbers;
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

double lds70a_rate_max_hz(std::uint32_t baud, PointCoding coding, std::size_t bytes) {
  struct Row {
    std::uint32_t baud;
    double binary;
    std::array<double, 4> decimal;  // of kBytes
  };
  constexpr std::array<std::size_t, 4> kBytes = {11, 16, 17, 22};
  constexpr std::array<Row, 7> kRows = {{{9600, 470, {80, 50, 48, 40}},
                                         {19'200, 940, {160, 100, 90, 75}},
                                         {115200, 5750, {1000, 700, 660, 480}},
                                         {230'400, 11'600, {2000, 1400, 1300, 980}},
                                         {460'800, 23'200, {4100, 2750, 2500, 1850}},
                                         {921'600, 40'000, {7300, 4750, 4350, 3300}},
                                         {2'000'000, 40'000, {12'200, 7850, 6480, 5000}}}};
  const auto* const row = std::ranges::find_if(kRows, [baud](const Row& each) { return each.baud >= baud; });
  const Row& found = row != kRows.end() ? *row : kRows.back();
  if (coding == PointCoding::SevenBit) {
    return found.binary;
  }
  const auto* const width = std::ranges::lower_bound(kBytes, bytes);
  return width != kBytes.end() ? found.decimal[static_cast<std::size_t>(width - kBytes.begin())]
                               : found.decimal.back();
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

PointCommands::PointCommands(const PointSettings& settings)
    : settings_(settings), format_(settings.format), baud_(settings.baud), frequency_hz_(settings.rate_hz) {
}

PointAnswer PointCommands::run(std::string_view line) {
  const std::string text = cleaned(line);
  const std::string command = text.substr(0, 2);
  const std::string values = cleaned(std::string_view(text).substr(command.size()));
  if (text == "ID") {
    return {settings_.identity + "\r\n", PointAction::None};
  }
  if (text == "DM" || text == "DT") {
    return {"", text == "DM" ? PointAction::Measure : PointAction::Track};
  }
  const auto numbers = numbers_in(values);
  const bool is_known = !value_of(command).empty();
  if (!is_known || !numbers || (!numbers->empty() && !set(command, *numbers))) {
    return {"?\r\n", PointAction::None};
  }
  return {command + " " + value_of(command) + "\r\n", PointAction::None};
}

std::string PointCommands::value_of(std::string_view command) const {
  if (command == "MF") {
    return fixed_text(frequency_hz_, 0);
  }
  if (command == "BR") {
    return std::to_string(baud_);
  }
  return command == "SD" ? "0 " + std::to_string(static_cast<unsigned>(format_.extras)) : "";
}

bool PointCommands::set(std::string_view command, const std::vector<double>& numbers) {
  if (command == "MF") {
    frequency_hz_ = std::clamp(numbers.front(), 1.0, kFrequencyMax_hz);
  } else if (command == "BR") {
    constexpr std::array<std::uint32_t, 7> kBauds = {9600,    19'200,  115200,   230'400,
                                                     460'800, 921'600, 2'000'000};
    baud_ = *std::ranges::min_element(kBauds, {},
                                      [&](std::uint32_t each) { return std::abs(each - numbers.front()); });
  } else {
    const double extras = numbers.size() > 1 ? numbers[1] : 0.0;
    if (numbers.front() != 0.0 || !(extras >= 0.0 && extras <= 3.0)) {
      return false;
    }
    format_.coding = PointCoding::Decimal;
    format_.extras = static_cast<PointExtras>(static_cast<unsigned>(extras));
  }
  return true;
}

double PointCommands::rate_hz() const {
  if (settings_.dialect == PointDialect::None) {
    return settings_.rate_hz;
  }
  const std::size_t bytes = point_record_bytes(format_);
  const double carried_hz =
      baud_ / (10.0 * static_cast<double>(bytes));  // the table allows 1 % more at times
  return std::min({frequency_hz_, carried_hz, lds70a_rate_max_hz(baud_, format_.coding, bytes)});
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
  if (!machine_.outbox.has_answers()) {
    line_.set_baud(commands_.baud());  // the answer to BR is still at the old rate
  }
}

void EmulatedPointLaser::start_up(Stamp now) {
  machine_.power.go_up();
  text_.clear();
  line_.set_baud(commands_.baud());
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
  if (answer.action == PointAction::Measure) {
    build_record(at);
    machine_.outbox.put_answer(record_, at, {&at, 1});
  } else if (answer.action == PointAction::Track) {
    track(at);
  }
}

void EmulatedPointLaser::track(Stamp at) {
  machine_.timer.start_after(at, commands_.rate_hz());
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
  if (!sight.has_echo() || (is_odd && !has_quality(commands_.format().extras))) {
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
      commands_.set_baud(kFactoryBaud);
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
