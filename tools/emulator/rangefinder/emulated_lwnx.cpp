#include "tools/emulator/rangefinder/emulated_lwnx.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::uint8_t kNameId = 0;
constexpr std::uint8_t kSerialNumberId = 3;
constexpr std::uint8_t kTextId = 7;
constexpr std::uint8_t kCommModeId = 28;
constexpr std::uint8_t kStreamId = 30;
constexpr std::uint64_t kSerialAtOnce = 1;
constexpr Stamp kErrorTextPeriod = std::chrono::milliseconds(500);

}  // namespace

EmulatedLwnx::EmulatedLwnx(const LwnxSettings& settings, ByteSink& sink, RangeScene& scene)
    : settings_(settings),
      product_(settings_.product),
      scene_(scene),
      line_(sink, settings.transmit_buffer_bytes),
      machine_(settings, line_, scene),
      registers_(product_),
      reader_(settings_),
      token_(settings.first_token) {
  registers_.set_text(kNameId, product_.name);
  registers_.set_text(kSerialNumberId, settings.serial_number);
  line_.set_baud(settings.baud != 0 ? settings.baud : product_.baud);
  if (const auto value = lwnx_baud_value(line_.baud())) {
    registers_.set(product_.ids.baud, std::uint64_t{*value});
  }
  registers_.save_all();
  if (machine_.power.is_up()) {
    start_up(Stamp::zero());
    unanswered_first_ = 0;
    unanswered_packets_ = 0;
    is_lwnx_ = settings.legacy == LwnxLegacyStream::None;
  }
}

void EmulatedLwnx::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    step(event);
  }
}

Stamp EmulatedLwnx::next_event() const {
  const Stamp next = machine_.next_event();
  return machine_.power.is_up() ? std::min({next, statistics_at_, text_at_}) : next;
}

void EmulatedLwnx::step(Stamp now) {
  if (!machine_.power.is_up()) {
    start_up(now);
    return;
  }
  if (machine_.takes_shot(now)) {
    shoot(now);
  }
  if (statistics_at_ <= now) {
    send_statistics(now);
  }
  if (text_at_ <= now) {
    say_due_text(now);
  }
  machine_.release(now);
  if (machine_.restart_at <= now) {
    go_down(now);
  }
}

void EmulatedLwnx::start_up(Stamp now) {
  machine_.power.go_up();
  registers_.restore();
  if (const auto baud = lwnx_baud(registers_.value(product_.ids.baud));
      baud && lwnx_baud_value(line_.baud()).has_value()) {
    line_.set_baud(*baud);
  }
  const bool is_chosen = registers_.value(kCommModeId) == kSerialAtOnce;
  unanswered_first_ = is_chosen ? 0 : product_.unanswered_first;
  unanswered_packets_ = product_.unanswered_packets;
  is_lwnx_ = false;
  text_.clear();
  text_stream_.reset();
  receiver_.clear();
  reader_.clear();
  text_at_ = error_is_on(now) ? now : hal::kNever;
  retime(now);
}

void EmulatedLwnx::go_down(Stamp until) {
  machine_.go_down(until);
  line_.clear();
  statistics_at_ = hal::kNever;
  text_at_ = hal::kNever;
}

bool EmulatedLwnx::inject(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::PowerCycle:
      go_down(fault.at + fault.duration);
      return true;
    case FaultKind::BaudReset:
      registers_.set(product_.ids.baud, lwnx_baud_value(product_.baud).value_or(0));
      registers_.save(product_.ids.baud);
      line_.set_baud(product_.baud);
      return true;
    case FaultKind::DeviceError:
      machine_.faults.open(fault);
      text_at_ = machine_.power.is_up() ? fault.at : hal::kNever;
      return true;
    case FaultKind::BadChecksum:
      machine_.faults.order(fault.kind);
      return true;
    case FaultKind::StreamStops:
      registers_.set(kStreamId, 0U);
      text_stream_.reset();
      retime(fault.at);
      return true;
    case FaultKind::TextMessage:
      say("Target range reset", fault.at);
      return true;
    default:
      return machine_.open(fault);
  }
}

void EmulatedLwnx::say(std::string_view text, Stamp at) {
  if (!machine_.power.is_up()) {
    return;
  }
  if (!is_lwnx_) {
    put_text(std::string(text) + "\r\n", at);
    return;
  }
  data_.assign(text.begin(), text.end());
  data_.push_back(0);
  put_packet(kTextId, LwnxAccess::Read, at);
}

void EmulatedLwnx::say_due_text(Stamp now) {
  if (error_is_on(now)) {
    say("Laser error", now);
    text_at_ = now + kErrorTextPeriod;
  } else if (!is_lwnx_ && settings_.screen_period > Stamp::zero()) {
    put_text(product_.text_name + " measuring\r\n", now);
    text_at_ = now + settings_.screen_period;
  } else {
    text_at_ = hal::kNever;
  }
}

}  // namespace slamsensor::tools
