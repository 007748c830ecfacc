#include "tools/emulator/rangefinder/tf03_commands.hpp"

#include "tools/emulator/rangefinder/tf03_frame.hpp"

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

}  // namespace slamsensor::tools
