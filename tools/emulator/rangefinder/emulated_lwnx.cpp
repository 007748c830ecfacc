#include "tools/emulator/rangefinder/emulated_lwnx.hpp"

#include "tools/world/random.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {

void set_rate(LwnxSettings& settings, double rate_hz) {
  LightWareProduct& product = settings.product;
  LwnxRegister* const rate = product.find(product.ids.update_rate);
  LwnxRegister* const high_speed = product.find(product.ids.high_speed);
  if (high_speed != nullptr) {
    high_speed->initial = 2.0 * rate_hz >= settings.full_speed_hz ? 1 : 0;
  }
  if (rate == nullptr) {
    return;
  }
  if (product.rates_hz.empty()) {
    rate->initial = std::clamp<std::int64_t>(std::llround(rate_hz * 10.0), 5, 100);
    return;
  }
  const auto nearest = std::ranges::min_element(
      product.rates_hz, {}, [rate_hz](double each) { return std::abs(std::log(each / rate_hz)); });
  rate->initial = product.first_rate_value + (nearest - product.rates_hz.begin());
}

namespace {

// Commands.
constexpr std::uint8_t kNameId = 0;
constexpr std::uint8_t kTextId = 7;
constexpr std::uint8_t kTokenId = 10;
constexpr std::uint8_t kSaveId = 12;
constexpr std::uint8_t kResetId = 14;
constexpr std::uint8_t kCommModeId = 28;
constexpr std::uint8_t kStreamId = 30;
constexpr std::uint8_t kRawId = 40;
constexpr std::uint8_t kCmId = 44;
constexpr std::uint8_t kMmId = 45;
constexpr std::uint8_t kLaserId = 50;

std::int64_t field_word(LwnxField field, const LwnxReading& reading, const LwnxUnit& unit) {
  if (field == LwnxField::Strength) {
    return reading.is_lost ? 0 : std::llround(reading.strength);
  }
  return distance_word(reading, reading.range_m, unit);
}

void pack_fields(const LightWareProduct& product, std::uint64_t bits, const LwnxReading& reading,
                 const LwnxUnit& unit, std::vector<std::uint8_t>& data) {
  for (std::size_t bit = 0; bit < product.fields.size(); ++bit) {
    if ((bits >> bit & 1U) != 0) {
      append_little_endian(field_word(product.fields[bit], reading, unit), unit.bytes, data);
    }
  }
}

}  // namespace

std::int64_t distance_word(const LwnxReading& reading, double range_m, const LwnxUnit& unit) {
  const auto highest = (std::int64_t{1} << (8 * unit.bytes - 1)) - 1;
  const std::int64_t word = std::llround(range_m * unit.units_per_m);
  return reading.is_lost || word > highest ? unit.no_return : word;
}

double LwnxReader::strength_of(const Sight& sight) const {
  if (sight.kind == SightKind::Weak) {
    return settings_.weak_strength;
  }
  return sight.kind == SightKind::Saturated ? settings_.saturated_strength : settings_.strength.of(sight);
}

LwnxReading LwnxReader::read(const Sight& sight, const Setup& setup) {
  const bool is_miss = !sight.has_echo() || (sight.kind == SightKind::Weak && !setup.tells_strength);
  if (!is_miss) {
    misses_ = 0;
    last_ = {false, sight.range_m, strength_of(sight)};
    return last_;
  }
  ++misses_;
  if (misses_ >=
      setup.lost_counter) {  // the counter's last miss is reported as lost: 1 (and 0) repeats nothing
    last_ = {};
  }
  return last_;
}

void LwnxReader::clear() {
  last_ = {};
  misses_ = 0;
}

void pack_cm(const LightWareProduct& product, std::uint64_t bits, const LwnxReading& reading,
             std::vector<std::uint8_t>& data) {
  const LwnxUnit unit{product.cm_units_per_m, product.cm_field_bytes, product.no_return};
  pack_fields(product, bits, reading, unit, data);
}

void pack_mm(const LightWareProduct& product, std::uint64_t bits, const LwnxReading& reading,
             std::vector<std::uint8_t>& data) {
  pack_fields(product, bits, reading, {1000.0, 4, product.no_return_mm}, data);
}

namespace {

constexpr std::uint64_t kSerialAtOnce = 1;
constexpr std::uint16_t kFirstToken = 0x1234;
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
      token_(kFirstToken) {
  registers_.set_text(kNameId, product_.name);
  line_.set_baud(settings.baud != 0 ? settings.baud : product_.baud);
  if (const auto value = lwnx_baud_value(line_.baud())) {
    registers_.set(product_.ids.baud, std::uint64_t{*value});
  }
  registers_.save_all();
  if (machine_.power.is_up()) {
    start_up(Stamp::zero());
    unanswered_first_ = 0;
    unanswered_packets_ = 0;
    is_lwnx_ = true;
  }
}

void EmulatedLwnx::advance(Stamp now) {
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    step(event);
  }
}

Stamp EmulatedLwnx::next_event() const {
  const Stamp next = machine_.next_event();
  return machine_.power.is_up() ? std::min(next, error_text_at_) : next;
}

void EmulatedLwnx::step(Stamp now) {
  if (!machine_.power.is_up()) {
    start_up(now);
    return;
  }
  if (machine_.takes_shot(now)) {
    shoot(now);
  }
  if (error_text_at_ <= now) {
    error_text_at_ = error_is_on(now) ? now + kErrorTextPeriod : hal::kNever;
    if (error_is_on(now)) {
      say("Laser error", now);
    }
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
  receiver_.clear();
  reader_.clear();
  error_text_at_ = error_is_on(now) ? now : hal::kNever;
  retime(now);
}

void EmulatedLwnx::go_down(Stamp until) {
  machine_.go_down(until);
  line_.clear();
  error_text_at_ = hal::kNever;
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
      error_text_at_ = machine_.power.is_up() ? fault.at : hal::kNever;
      return true;
    case FaultKind::BadChecksum:
      machine_.faults.order(fault.kind);
      return true;
    case FaultKind::StreamStops:
      registers_.set(kStreamId, 0U);
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
    const std::string line = std::string(text) + "\r\n";
    machine_.outbox.put_answer(std::vector<std::uint8_t>(line.begin(), line.end()), at);
    return;
  }
  data_.assign(text.begin(), text.end());
  data_.push_back(0);
  put_packet(kTextId, RequestAccess::Read, at);
}

void EmulatedLwnx::receive(std::uint8_t byte, Stamp at) {
  if (!machine_.power.is_up()) {
    return;
  }
  if (const auto request = receiver_.push(byte, at)) {
    take_request(*request, at);
  } else if (!receiver_.in_packet() && byte == '\n' && unanswered_first_ > 0) {
    --unanswered_first_;  // a line of text, which chooses the interface
  }
}

void EmulatedLwnx::take_request(const LwnxRequest& request, Stamp at) {
  if (unanswered_first_ > 0) {
    --unanswered_first_;
    return;
  }
  enter_lwnx(at);
  if (unanswered_packets_ > 0) {
    --unanswered_packets_;
    return;
  }
  const LwnxRegister* const command = product_.find(request.id);
  if (command == nullptr) {
    ++refused_;
  } else if (request.access == RequestAccess::Write) {
    answer_write(*command, request, at);
  } else if (command->read_bytes > 0 && request.data.empty()) {
    answer_read(*command, at);
  } else {
    ++refused_;
  }
}

void EmulatedLwnx::enter_lwnx(Stamp at) {
  if (is_lwnx_) {
    return;
  }
  is_lwnx_ = true;
  retime(at);
}

void EmulatedLwnx::answer_read(const LwnxRegister& command, Stamp at) {
  if (command.id == kCmId || command.id == kMmId || command.id == kRawId) {
    answer_distance(command.id, at);
    return;
  }
  if (command.id == kTokenId) {
    registers_.set(kTokenId, std::uint64_t{token_});
  }
  const auto bytes = registers_.bytes(command.id);
  data_.assign(bytes.begin(), bytes.end());
  put_packet(command.id, RequestAccess::Read, at);
}

void EmulatedLwnx::answer_distance(std::uint8_t id, Stamp at) {
  const LwnxReading reading = measure(at);
  data_.clear();
  const std::uint64_t bits = registers_.value(product_.ids.distance_output);
  if (id == kCmId) {
    pack_cm(product_, bits, reading, data_);
  } else if (id == kMmId) {
    pack_mm(product_, bits, reading, data_);
  } else {
    data_.push_back(1);
    append_little_endian(distance_word(reading, reading.range_m, {100.0, 2, product_.no_return}), 2, data_);
  }
  build_packet(id, RequestAccess::Read, data_, packet_);
  machine_.outbox.put_answer(packet_, at, {&at, 1});
}

void EmulatedLwnx::answer_write(const LwnxRegister& command, const LwnxRequest& request, Stamp at) {
  if (!command.write_bytes || *command.write_bytes != request.data.size() || !write(request, at)) {
    ++refused_;
    return;
  }
  data_.clear();
  const auto kept = registers_.bytes(command.id);
  data_.assign(kept.begin(), kept.end());  // save and reset have none
  put_packet(command.id, RequestAccess::Write, at);
}

bool EmulatedLwnx::write(const LwnxRequest& request, Stamp at) {
  const std::uint64_t value = little_endian(request.data);
  const LwnxIds& ids = product_.ids;
  if (request.id == ids.update_rate) {
    if (product_.rate_hz(value)) {
      registers_.set(request.id, request.data);
      retime(at);
    }
  } else if (request.id == ids.baud) {
    if (lwnx_baud(value)) {
      registers_.set(request.id, request.data);  // the line keeps its rate until the next start
    }
  } else if (request.id == ids.lost_counter) {
    if (value >= product_.lost_counter_min) {
      registers_.set(request.id, request.data);
    }
  } else if (request.id == ids.high_speed) {
    registers_.set(request.id, value & 1U);
    retime(at);
  } else {
    return write_common(request, at);
  }
  return true;
}

bool EmulatedLwnx::write_common(const LwnxRequest& request, Stamp at) {
  const std::uint64_t value = little_endian(request.data);
  switch (request.id) {
    case kSaveId:
      if (!use_token(request)) {
        return false;
      }
      registers_.save();
      return true;
    case kResetId:
      if (!use_token(request)) {
        return false;
      }
      machine_.restart_at = at + settings_.restart_delay;
      return true;
    case kStreamId:
      if (product_.stream(static_cast<std::uint32_t>(value))) {
        registers_.set(request.id, request.data);
        retime(at);
      }
      return true;
    default:
      registers_.set(request.id, request.data);
      return true;
  }
}

bool EmulatedLwnx::use_token(const LwnxRequest& request) {
  if (little_endian(request.data) != token_) {
    return false;
  }
  ++tokens_;
  token_ = static_cast<std::uint16_t>(mix_seed(settings_.seed, tokens_));
  return true;
}

void EmulatedLwnx::put_packet(std::uint8_t id, RequestAccess access, Stamp at) {
  build_packet(id, access, data_, packet_);
  machine_.outbox.put_answer(packet_, at);
}

LwnxStream EmulatedLwnx::stream() const {
  if (!is_lwnx_) {
    return LwnxStream::Off;
  }
  return product_.stream(static_cast<std::uint32_t>(registers_.value(kStreamId))).value_or(LwnxStream::Off);
}

double EmulatedLwnx::rate_hz(LwnxStream stream) const {
  const bool has_switch = product_.find(product_.ids.high_speed) != nullptr;
  const bool is_fast = !has_switch || registers_.value(product_.ids.high_speed) == 1;
  if (stream == LwnxStream::Raw && is_fast) {
    return settings_.full_speed_hz;
  }
  return product_.rate_hz(registers_.value(product_.ids.update_rate)).value_or(1.0);
}

void EmulatedLwnx::retime(Stamp now) {
  raw_.clear();
  raw_measured_.clear();
  const LwnxStream kind = stream();
  if (kind == LwnxStream::Off) {
    machine_.timer.stop();
  } else {
    machine_.timer.start_after(now, rate_hz(kind));
  }
}

bool EmulatedLwnx::tells_strength() const {
  const LwnxStream kind = stream();
  if (kind == LwnxStream::Raw) {
    return false;
  }
  const std::uint64_t bits = registers_.value(product_.ids.distance_output);
  for (std::size_t bit = 0; bit < product_.fields.size(); ++bit) {
    if ((bits >> bit & 1U) != 0 && product_.fields[bit] == LwnxField::Strength) {
      return true;
    }
  }
  return false;
}

LwnxReading EmulatedLwnx::measure(Stamp at) {
  if (registers_.value(kLaserId) == 0 || error_is_on(at)) {
    return {};
  }
  const auto lost_counter = static_cast<std::uint32_t>(registers_.value(product_.ids.lost_counter));
  return reader_.read(look(scene_, at, machine_.faults), {lost_counter, tells_strength()});
}

void EmulatedLwnx::shoot(Stamp at) {
  if (error_is_on(at)) {
    return;  // text comes instead
  }
  const LwnxReading reading = measure(at);
  const LwnxStream kind = stream();
  if (kind == LwnxStream::Raw) {
    stream_raw(reading, at);
  } else {
    stream_packet(kind, reading, at);
  }
}

void EmulatedLwnx::stream_packet(LwnxStream stream, const LwnxReading& reading, Stamp at) {
  data_.clear();
  const std::uint64_t bits = registers_.value(product_.ids.distance_output);
  if (stream == LwnxStream::Cm) {
    pack_cm(product_, bits, reading, data_);
    put_record(kCmId, {&at, 1}, at);
  } else {
    pack_mm(product_, bits, reading, data_);
    put_record(kMmId, {&at, 1}, at);
  }
}

void EmulatedLwnx::stream_raw(const LwnxReading& reading, Stamp at) {
  append_little_endian(distance_word(reading, reading.range_m, {100.0, 2, product_.no_return}), 2, raw_);
  raw_measured_.push_back(at);
  if (raw_measured_.size() < settings_.raw_readings) {
    return;
  }
  data_.assign(1, settings_.raw_readings);
  data_.insert(data_.end(), raw_.begin(), raw_.end());
  put_record(kRawId, raw_measured_, at);
  raw_.clear();
  raw_measured_.clear();
}

void EmulatedLwnx::put_record(std::uint8_t id, std::span<const Stamp> measured, Stamp at) {
  build_packet(id, RequestAccess::Read, data_, packet_);
  if (machine_.faults.take(FaultKind::BadChecksum)) {
    packet_.back() ^= 0x5AU;
  }
  machine_.outbox.put_record(packet_, measured, at);
}

}  // namespace slamsensor::tools
