#include "tools/emulator/rangefinder/emulated_tf03.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::tools {
namespace {

constexpr std::array<std::uint32_t, 17> kBauds = {9600,    14'400,  19'200,  38'400,  56'000,   57'600,
                                                  115200,  128'000, 230'400, 256'000, 460'800,  500'000,
                                                  512'000, 600'000, 750'000, 921'600, 1'000'000};
constexpr std::array<std::uint32_t, 9> kCanBauds = {1'000'000, 800'000, 500'000, 250'000, 125'000,
                                                    100'000,   50'000,  40'000,  20'000};

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

Tf03Answer done(std::uint8_t id, Tf03Action action = Tf03Action::None) {
  return answer(id, std::array<std::uint8_t, 1>{0}, action);
}

std::size_t payload_bytes(std::uint8_t id) {
  switch (id) {
    case 0x03:
    case 0x4F:
      return 2;
    case 0x05:
    case 0x07:
    case 0x08:
    case 0x45:
    case 0x5D:
      return 1;
    case 0x06:
    case 0x50:
    case 0x51:
    case 0x52:
      return 4;
    default:
      return 0;
  }
}

std::uint32_t known_rate(BenewakeModel model, std::uint32_t rate_hz) {
  constexpr std::uint32_t kOtherwise = 100;
  if (model != BenewakeModel::Tf03) {
    return std::min<std::uint32_t>(rate_hz, 1000);
  }
  return rate_hz == 0 || (rate_hz <= 10'000 && nearest_tf03_rate(rate_hz) == rate_hz) ? rate_hz : kOtherwise;
}

}  // namespace

Tf03Commands::Tf03Commands(const Tf03Settings& settings)
    : settings_(settings), saved_(settings.saved), wanted_(saved_), active_(saved_) {
}

void Tf03Commands::start_up() {
  wanted_ = saved_;
  active_ = saved_;
}

void Tf03Commands::reset_baud() {
  saved_.baud = wanted_.baud = active_.baud = Tf03Parameters{}.baud;
}

void Tf03Commands::apply() {
  Tf03Parameters next = wanted_;
  if (settings_.baud_change == Tf03BaudChange::AfterRestart) {
    next.baud = active_.baud;
  }
  next.wire = active_.wire;
  next.can_send_id = active_.can_send_id;
  next.can_receive_id = active_.can_receive_id;
  next.can_baud = active_.can_baud;
  active_ = next;
}

std::optional<Tf03Answer> Tf03Commands::run(std::span<const std::uint8_t> command) {
  const std::uint8_t id = command[2];
  const Payload payload = command.subspan(3, command.size() - 4);
  if (payload.size() != payload_bytes(id)) {
    return std::nullopt;
  }
  std::optional<Tf03Answer> result;
  switch (id) {
    case 0x01:
      return answer(id, settings_.version);
    case 0x02:
      return done(id, Tf03Action::Restart);
    case 0x10:
      wanted_ = Tf03Parameters{};
      wanted_.wire = saved_.wire;  // the plug does not change with it
      saved_ = wanted_;
      result = done(id, Tf03Action::Retime);
      break;
    case 0x11:
      saved_ = wanted_;
      return done(id);
    default:
      result = id < 0x10 ? run_measuring(id, payload) : run_line(id, payload);
  }
  apply();
  return result;
}

std::optional<Tf03Answer> Tf03Commands::run_measuring(std::uint8_t id, Payload payload) {
  const std::uint32_t value = number(payload);
  const auto as_switch = value == 0 ? Tf03Switch::Off : Tf03Switch::On;
  switch (id) {
    case 0x03: {
      wanted_.rate_hz = known_rate(settings_.model, value);
      const std::array<std::uint8_t, 2> rate = {static_cast<std::uint8_t>(wanted_.rate_hz & 0xFFU),
                                                static_cast<std::uint8_t>(wanted_.rate_hz >> 8U)};
      return answer(id, rate, Tf03Action::Retime);
    }
    case 0x04:
      return wanted_.rate_hz == 0 ? std::optional(Tf03Answer{{}, Tf03Action::Trigger}) : std::nullopt;
    case 0x05:
      if (value != 1 && value != 2) {
        return std::nullopt;
      }
      wanted_.format = static_cast<Tf03Format>(value);
      return answer(id, payload);
    case 0x06:
      return set_baud(payload);
    case 0x07:
      wanted_.output = as_switch;
      return answer(id, payload);
    case 0x08:
      wanted_.checks_sums = as_switch;
      return answer(id, payload);
    default:
      return std::nullopt;
  }
}

std::optional<Tf03Answer> Tf03Commands::set_baud(Payload payload) {
  constexpr std::uint32_t kOtherwise = 115200;
  const std::uint32_t baud = number(payload);
  wanted_.baud = std::ranges::find(kBauds, baud) != kBauds.end() ? baud : kOtherwise;
  std::array<std::uint8_t, 4> kept{};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    kept[i] = static_cast<std::uint8_t>(wanted_.baud >> (8 * i) & 0xFFU);
  }
  return answer(0x06, kept);
}

std::optional<Tf03Answer> Tf03Commands::run_line(std::uint8_t id, Payload payload) {
  if (settings_.model != BenewakeModel::Tf03) {
    return std::nullopt;
  }
  const std::uint32_t value = number(payload);
  switch (id) {
    case 0x45:
      return set_wire(payload);
    case 0x4F:
      if (value == 0xFFFF) {
        return std::nullopt;
      }
      wanted_.over_range_cm = static_cast<std::uint16_t>(value);
      return done(id);
    case 0x5D:
      wanted_.can_extended = value == 0 ? Tf03Switch::Off : Tf03Switch::On;
      return answer(id, payload);
    default:
      return set_can(id, value) ? std::optional(done(id)) : std::nullopt;
  }
}

std::optional<Tf03Answer> Tf03Commands::set_wire(Payload payload) {
  constexpr std::uint8_t kUart = 1;
  if (payload[0] != kUart && payload[0] != settings_.use_can_code) {
    return std::nullopt;
  }
  wanted_.wire = payload[0] == kUart ? Tf03Wire::Uart : Tf03Wire::Can;
  return answer(0x45, payload);
}

bool Tf03Commands::set_can(std::uint8_t id, std::uint32_t value) {
  switch (id) {
    case 0x50:
      wanted_.can_send_id = value;
      return true;
    case 0x51:
      wanted_.can_receive_id = value;
      return true;
    case 0x52:
      wanted_.can_baud = std::ranges::find(kCanBauds, value) != kCanBauds.end() ? value : kCanBauds.front();
      return true;
    default:
      return false;
  }
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
