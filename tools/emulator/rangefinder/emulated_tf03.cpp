#include "tools/emulator/rangefinder/emulated_tf03.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace slamsensor::tools {

Tf03Settings tf03_settings(BenewakeModel model) {
  Tf03Settings settings;
  settings.model = model;
  switch (model) {
    case BenewakeModel::Tf03:
      break;
    case BenewakeModel::TfMini:
      settings.no_return_cm = 65'535;
      settings.strength_min = 20.0;
      settings.strength_of_weak = 10;
      break;
    case BenewakeModel::TfMiniPlus:
      settings.no_return_cm = 0;
      settings.strength_min = 100.0;
      settings.strength_of_weak = 60;
      settings.strength_of_blinded = 65'535;
      break;
    case BenewakeModel::TfMiniS:
      settings.no_return_cm = 65'535;  // -1: too faint
      settings.strength_min = 100.0;
      settings.strength_of_weak = 60;
      settings.strength_of_blinded = 65'535;
      break;
    case BenewakeModel::Tf02:
      settings.no_return_cm = 2'200;
      break;
  }
  return settings;
}

std::uint32_t nearest_tf03_rate(double rate_hz) {
  const double limited = std::clamp(rate_hz, 1.0, 10'000.0);
  const double decade = std::pow(10.0, std::min(3.0, std::floor(std::log10(limited))));
  return static_cast<std::uint32_t>(std::llround(std::round(limited / decade) * decade));
}

void set_rate(Tf03Settings& settings, double rate_hz) {
  settings.saved.rate_hz = nearest_tf03_rate(rate_hz);
}

namespace {

constexpr std::uint8_t kFrameMark = 0x59;
constexpr std::uint8_t kCommandMark = 0x5A;
constexpr std::size_t kCommandMin = 4;
constexpr std::size_t kCommandMax = 16;
constexpr Stamp kPause = std::chrono::milliseconds(100);
constexpr std::uint16_t kTooBright = 0xFFFE;      // -2 of the TFmini-S
constexpr std::uint16_t kTooSunny = 0xFFFC;       // -4
constexpr std::uint32_t kStrengthRateMax = 1000;  // above it only the distance is reported

std::uint8_t low(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xFFU);
}

std::uint8_t sum_of(std::span<const std::uint8_t> bytes) {
  return low(std::accumulate(bytes.begin(), bytes.end(), 0U));
}

std::uint16_t nothing_word(const Tf03Settings& settings, const Tf03Parameters& parameters) {
  if (settings.model != BenewakeModel::Tf03) {
    return settings.no_return_cm;
  }
  return parameters.over_range_cm != 0 ? parameters.over_range_cm : settings.no_return_cm;
}

std::uint16_t strength_word(const Tf03Settings& settings, const Sight& sight) {
  switch (sight.kind) {
    case SightKind::Weak:
      return settings.strength_of_weak;
    case SightKind::Saturated:
      return settings.strength_of_blinded;
    case SightKind::Target:
      return static_cast<std::uint16_t>(settings.strength.of(sight));
    case SightKind::Nothing:
    case SightKind::Error:
      break;
  }
  return settings.strength_of_nothing;
}

bool is_beyond(const Tf03Settings& settings, const Tf03Parameters& parameters, double cm) {
  const bool is_limited = settings.model == BenewakeModel::Tf03 && parameters.over_range_cm != 0;
  return cm > (is_limited ? parameters.over_range_cm : 65'000.0);
}

/// Bytes 6 and 7 of the frame.
std::array<std::uint8_t, 2> model_bytes(const Tf03Settings& settings, const Tf03Words& words) {
  switch (settings.model) {
    case BenewakeModel::Tf03:
      return {0, 0};
    case BenewakeModel::TfMini:
      return {words.distance < 500 ? std::uint8_t{2} : std::uint8_t{7}, 0};  // short or long range
    case BenewakeModel::Tf02:
      return {words.is_trusted ? std::uint8_t{8} : std::uint8_t{1}, 6};
    case BenewakeModel::TfMiniPlus:
    case BenewakeModel::TfMiniS:
      break;
  }
  const auto raw = static_cast<unsigned>(std::lround((settings.temperature_c + 256.0) * 8.0));
  return {low(raw), low(raw >> 8U)};
}

}  // namespace

Tf03Words tf03_words(const Tf03Settings& settings, const Tf03Parameters& parameters, const Sight& sight) {
  Tf03Words words{nothing_word(settings, parameters), strength_word(settings, sight), false};
  const double cm = std::round(sight.range_m * 100.0);
  const bool is_strong = words.strength >= settings.strength_min;
  const bool is_hidden = sight.kind == SightKind::Saturated && settings.model != BenewakeModel::Tf03;
  if (sight.has_echo() && is_strong && !is_hidden && !is_beyond(settings, parameters, cm)) {
    words.distance = static_cast<std::uint16_t>(std::max(cm, 0.0));
    words.is_trusted = true;
  } else if (settings.model == BenewakeModel::TfMiniS && sight.kind == SightKind::Saturated) {
    words.distance = kTooBright;
  } else if (settings.model == BenewakeModel::TfMiniS && sight.kind == SightKind::Error) {
    words.distance = kTooSunny;
  }
  if (parameters.rate_hz > kStrengthRateMax) {
    words.strength = 0;
  }
  return words;
}

void build_tf03_frame(const Tf03Settings& settings, const Tf03Words& words, std::vector<std::uint8_t>& out) {
  const auto [sixth, seventh] = model_bytes(settings, words);
  out = {kFrameMark,
         kFrameMark,
         low(words.distance),
         low(words.distance / 256U),
         low(words.strength),
         low(words.strength / 256U),
         sixth,
         seventh};
  out.push_back(sum_of(out));
}

void build_tf03_can(const Tf03Words& words, std::vector<std::uint8_t>& out) {
  out = {low(words.distance), low(words.distance / 256U), low(words.strength), low(words.strength / 256U)};
  out.resize(8);
}

std::vector<std::uint8_t> with_tf03_sum(std::vector<std::uint8_t> body) {
  body.push_back(sum_of(body));
  return body;
}

std::optional<std::vector<std::uint8_t>> Tf03Receiver::push(std::uint8_t byte, Stamp at) {
  if (at - last_byte_ > kPause) {
    buffer_.clear();
  }
  last_byte_ = at;
  if (buffer_.empty() && byte != kCommandMark) {
    return std::nullopt;
  }
  buffer_.push_back(byte);
  return take();
}

std::optional<std::vector<std::uint8_t>> Tf03Receiver::take() {
  while (buffer_.size() >= 2) {
    const std::size_t length = buffer_[1];
    const bool is_possible = length >= kCommandMin && length <= kCommandMax;
    if (is_possible && buffer_.size() < length) {
      return std::nullopt;
    }
    if (is_possible) {
      const std::span<const std::uint8_t> command(buffer_.data(), length);
      if (sum_of(command.first(length - 1)) == command.back()) {
        std::vector<std::uint8_t> whole(command.begin(), command.end());
        buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(length));
        return whole;
      }
    }
    ++refused_;
    buffer_.erase(buffer_.begin(), std::find(buffer_.begin() + 1, buffer_.end(), kCommandMark));
  }
  return std::nullopt;
}

namespace {

constexpr std::array<std::uint32_t, 17> kBauds = {9600,    14'400,  19'200,  38'400,  56'000,   57'600,
                                                  115200,  128'000, 230'400, 256'000, 460'800,  500'000,
                                                  512'000, 600'000, 750'000, 921'600, 1'000'000};

std::uint32_t number(std::span<const std::uint8_t> payload) {
  std::uint32_t value = 0;
  for (std::size_t i = std::min<std::size_t>(payload.size(), 4); i > 0; --i) {
    value = value << 8U | payload[i - 1];
  }
  return value;
}

Tf03Answer answer(std::uint8_t id, std::span<const std::uint8_t> payload,
                  Tf03Action action = Tf03Action::None) {
  std::vector<std::uint8_t> body = {0x5A, static_cast<std::uint8_t>(payload.size() + 4), id};
  body.insert(body.end(), payload.begin(), payload.end());
  return {with_tf03_sum(std::move(body)), action};
}

std::uint32_t known_rate(BenewakeModel model, std::uint32_t rate_hz) {
  constexpr std::uint32_t kOtherwise = 100;
  if (model != BenewakeModel::Tf03) {
    return std::clamp<std::uint32_t>(rate_hz, 1, 1000);
  }
  return rate_hz <= 10'000 && nearest_tf03_rate(rate_hz) == rate_hz ? rate_hz : kOtherwise;
}

}  // namespace

Tf03Commands::Tf03Commands(const Tf03Settings& settings)
    : settings_(settings), saved_(settings.saved), active_(saved_) {
}

void Tf03Commands::start_up() {
  active_ = saved_;
}

void Tf03Commands::reset_baud() {
  saved_.baud = active_.baud = Tf03Parameters{}.baud;
}

std::optional<Tf03Answer> Tf03Commands::run(std::span<const std::uint8_t> command) {
  const std::uint8_t id = command[2];
  const Payload payload = command.subspan(3, command.size() - 4);
  const std::uint32_t value = number(payload);
  if (id == 0x01 && payload.empty()) {
    return answer(id, settings_.version);
  }
  if (id == 0x03 && payload.size() == 2) {
    active_.rate_hz = known_rate(settings_.model, value);
    const std::array<std::uint8_t, 2> rate = {static_cast<std::uint8_t>(active_.rate_hz & 0xFFU),
                                              static_cast<std::uint8_t>(active_.rate_hz >> 8U)};
    return answer(id, rate, Tf03Action::Retime);
  }
  if (id == 0x05 && payload.size() == 1 && value == 1) {
    return answer(id, payload);
  }
  if (id == 0x06 && payload.size() == 4) {
    return set_baud(payload);
  }
  if (id == 0x07 && payload.size() == 1) {
    active_.output = value == 0 ? Tf03Switch::Off : Tf03Switch::On;
    return answer(id, payload);
  }
  if (id == 0x4F && payload.size() == 2 && value != 0xFFFF && settings_.model == BenewakeModel::Tf03) {
    active_.over_range_cm = static_cast<std::uint16_t>(value);
    return answer(id, std::array<std::uint8_t, 1>{0});
  }
  return std::nullopt;
}

std::optional<Tf03Answer> Tf03Commands::set_baud(Payload payload) {
  constexpr std::uint32_t kOtherwise = 115200;
  const std::uint32_t asked = number(payload);
  const std::uint32_t baud = std::ranges::find(kBauds, asked) != kBauds.end() ? asked : kOtherwise;
  std::array<std::uint8_t, 4> kept{};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    kept[i] = static_cast<std::uint8_t>(baud >> (8 * i) & 0xFFU);
  }
  return answer(0x06, kept);
}

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
  if (!hears()) {
    machine_.timer.stop();
  } else {
    machine_.timer.start_after(now, active().rate_hz);
  }
}

void Tf03Engine::shoot(Stamp at) {
  const Sight sight = look(scene_, at, machine_.faults);
  const Tf03Words words = tf03_words(settings_, active(), sight);
  if (wire_ == Tf03Wire::Can) {
    build_tf03_can(words, frame_);
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
  if (const auto command = receiver_.push(byte, at)) {
    run(*command, at);
  }
}

void Tf03Engine::run(std::span<const std::uint8_t> command, Stamp at) {
  const auto answer = commands_.run(command);
  if (!answer) {
    ++refused_;
    return;
  }
  machine_.outbox.put_answer(answer->bytes, at);
  if (answer->action == Tf03Action::Retime) {
    retime(at);
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
  if (!is_on_bus() || frame.id != engine_.active().can_receive_id) {
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
