#include "tools/emulator/emulated_port.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace slamsensor::tools {
namespace {

using hal::Stamp;

constexpr int kBits = 10;  // of a character
constexpr double kToleratedMismatch = 0.03;

Stamp half_bits(int count, std::uint32_t baud) noexcept {
  return Stamp(static_cast<Stamp::rep>(count) * 500'000'000 / static_cast<Stamp::rep>(baud));
}

bool is_high(std::uint8_t value, int bit) noexcept {
  return bit < 0 || bit == kBits - 1 || (bit > 0 && ((value >> (bit - 1)) & 1) != 0);
}

bool is_high_at(const std::deque<LineByte>& line, Stamp time) noexcept {
  const auto after = std::upper_bound(line.begin(), line.end(), time,
                                      [](Stamp t, const LineByte& b) { return t < b.begin; });
  if (after == line.begin()) {
    return true;
  }
  const LineByte& byte = *std::prev(after);
  if (time >= byte.end) {
    return true;
  }
  const auto bit = (time - byte.begin).count() * static_cast<Stamp::rep>(byte.baud) / 1'000'000'000;
  return is_high(byte.value, static_cast<int>(bit));
}

std::optional<Stamp> falling_edge(const LineByte& byte, Stamp from) noexcept {
  for (int bit = 0; bit < kBits && byte.end > from; ++bit) {
    const Stamp edge = byte.begin + half_bits(2 * bit, byte.baud);
    if (edge >= from && !is_high(byte.value, bit) && is_high(byte.value, bit - 1)) {
      return edge;
    }
  }
  return std::nullopt;
}

std::optional<Stamp> falling_edge(const std::deque<LineByte>& line, Stamp from) noexcept {
  const auto ends_later = [](Stamp t, const LineByte& b) { return t < b.end; };
  for (auto byte = std::upper_bound(line.begin(), line.end(), from, ends_later); byte != line.end(); ++byte) {
    if (const std::optional<Stamp> edge = falling_edge(*byte, from)) {
      return edge;
    }
  }
  return std::nullopt;
}

/// Where the receiver looks for the start bit itself.
Stamp start_middle(Stamp edge, std::uint32_t baud) noexcept {
  return edge + half_bits(1, baud);
}

Stamp after_glitch(Stamp edge, std::uint32_t baud) noexcept {
  return std::max(start_middle(edge, baud), edge + Stamp(1));
}

WireByte sampled(const std::deque<LineByte>& line, Stamp edge, std::uint32_t baud) noexcept {
  unsigned value = 0;
  for (int bit = 1; bit < kBits - 1; ++bit) {
    const bool high = is_high_at(line, edge + half_bits(2 * bit + 1, baud));
    value |= high ? 1U << static_cast<unsigned>(bit - 1) : 0U;
  }
  const Stamp stop = edge + half_bits(2 * kBits - 1, baud);
  return {is_high_at(line, stop) ? static_cast<std::uint8_t>(value) : std::uint8_t{0}, stop};
}

}  // namespace

bool rates_agree(std::uint32_t sender_baud, std::uint32_t receiver_baud) noexcept {
  const double sender = sender_baud;
  return std::abs(sender - static_cast<double>(receiver_baud)) <= kToleratedMismatch * sender;
}

bool has_falling_edge(const LineByte& byte, Stamp from) noexcept {
  return falling_edge(byte, from).has_value();
}

Stamp skip_glitches(const std::deque<LineByte>& line, Stamp from, Stamp now, std::uint32_t baud) {
  while (const std::optional<Stamp> edge = falling_edge(line, from)) {
    const Stamp middle = start_middle(*edge, baud);
    if (middle > now || !is_high_at(line, middle)) {
      break;
    }
    from = after_glitch(*edge, baud);
  }
  return from;
}

std::optional<WireByte> sample_character(const std::deque<LineByte>& line, Stamp from, std::uint32_t baud) {
  while (const std::optional<Stamp> edge = falling_edge(line, from)) {
    if (!is_high_at(line, start_middle(*edge, baud))) {
      return sampled(line, *edge, baud);
    }
    from = after_glitch(*edge, baud);
  }
  return std::nullopt;
}

namespace {

using hal::Stamp;

constexpr double kNoiseGap_bytes = 4.0;    // mean time between two bytes of noise
constexpr double kNoiseHits_share = 0.25;  // of the real bytes, while there is noise

}  // namespace

void SerialWire::send(std::span<const std::uint8_t> bytes, Stamp at, std::uint32_t baud) {
  for (const std::uint8_t value : bytes) {
    put(value, at, std::max(baud, 1U));
  }
}

void SerialWire::put(std::uint8_t value, Stamp at, std::uint32_t baud) {
  // Counted from the begin of the run, so that rounding to the nanosecond never adds up; a run of `baud`
  // bytes is exactly 10 s.
  const bool follows = at <= busy_until_ && baud == run_baud_ && run_count_ < baud;
  if (!follows) {
    run_begin_ = std::max(at, busy_until_);
    run_count_ = 0;
    run_baud_ = baud;
  }
  const Stamp begin = run_begin_ + hal::line_time(run_count_, baud);
  const Stamp end = run_begin_ + hal::line_time(++run_count_, baud);
  line_.push_back({value, begin, end, baud});
  busy_until_ = end;
}

void SerialWire::put_again_from(Stamp from) {
  const std::deque<LineByte> held = std::exchange(line_, {});
  busy_until_ = from;
  run_baud_ = 0;
  for (const LineByte& byte : held) {
    put(byte.value, byte.begin, byte.baud);
  }
}

void SerialWire::clear() {
  line_.clear();
  doubled_.reset();
  busy_until_ = Stamp{};
  run_baud_ = 0;
}

bool SerialWire::is_read_whole(const LineByte& byte, std::uint32_t receiver_baud) const noexcept {
  return byte.begin >= sampled_until_ && rates_agree(byte.baud, receiver_baud);
}

Stamp SerialWire::line_arrival(std::uint32_t receiver_baud) const {
  if (line_.empty()) {
    return hal::kNever;
  }
  if (is_read_whole(line_.front(), receiver_baud)) {
    return line_.front().end;
  }
  const std::optional<WireByte> sampled = sample_character(line_, sampled_until_, receiver_baud);
  return sampled ? sampled->at : hal::kNever;
}

Stamp SerialWire::next_arrival(std::uint32_t receiver_baud) const {
  const Stamp doubled = doubled_ ? doubled_->at : hal::kNever;
  return std::min({doubled, next_noise_, line_arrival(receiver_baud)});
}

void SerialWire::drop_sampled() {
  while (!line_.empty() && !has_falling_edge(line_.front(), sampled_until_)) {
    line_.pop_front();  // no character can begin there any more
  }
}

std::optional<WireByte> SerialWire::next_of_line(Stamp now, std::uint32_t receiver_baud) {
  drop_sampled();
  if (!line_.empty() && !is_read_whole(line_.front(), receiver_baud)) {
    // A stream of glitches must not be judged again and again.
    sampled_until_ = skip_glitches(line_, sampled_until_, now, receiver_baud);
    drop_sampled();
  }
  if (line_.empty()) {
    return std::nullopt;
  }
  const bool whole = is_read_whole(line_.front(), receiver_baud);
  const std::optional<WireByte> byte = whole ? WireByte{line_.front().value, line_.front().end}
                                             : sample_character(line_, sampled_until_, receiver_baud);
  if (!byte || byte->at > now) {
    return std::nullopt;
  }
  sampled_until_ = byte->at;
  if (whole) {
    line_.pop_front();
  }
  return byte;
}

std::optional<WireByte> SerialWire::next(Stamp now, std::uint32_t receiver_baud) {
  const std::uint32_t baud = std::max(receiver_baud, 1U);
  while (true) {
    if (doubled_ && doubled_->at <= now) {
      return std::exchange(doubled_, std::nullopt);
    }
    if (next_noise_ <= now && next_noise_ <= line_arrival(baud)) {
      return noise_byte(baud);
    }
    const std::optional<WireByte> byte = next_of_line(now, baud);
    if (!byte) {
      return std::nullopt;
    }
    if (const std::optional<WireByte> left = disturbed(*byte, baud)) {
      return left;
    }
  }
}

std::optional<WireByte> SerialWire::disturbed(WireByte byte, std::uint32_t receiver_baud) {
  if (drops_ > 0) {
    --drops_;
    return std::nullopt;
  }
  if (corruptions_ > 0) {
    --corruptions_;
    byte.value = static_cast<std::uint8_t>(byte.value ^ (1U << (rng_() % 8)));
  }
  if (byte.at < noise_until_ && draw_unit(rng_) < kNoiseHits_share) {
    byte.value = static_cast<std::uint8_t>(rng_());
  }
  if (doubles_ > 0) {
    --doubles_;
    doubled_ = WireByte{byte.value, byte.at + hal::line_time(1, receiver_baud)};
    if (!line_.empty()) {
      put_again_from(doubled_->at);
    }
    busy_until_ = std::max(busy_until_, doubled_->at);
  }
  return byte;
}

WireByte SerialWire::noise_byte(std::uint32_t receiver_baud) {
  const WireByte noise{static_cast<std::uint8_t>(rng_()), next_noise_};
  draw_noise_gap(receiver_baud);
  return noise;
}

void SerialWire::draw_noise_gap(std::uint32_t receiver_baud) {
  const double byte_s = hal::to_seconds(hal::line_time(1, receiver_baud));
  const double gap_s = byte_s * (1.0 + free_path_m(draw_unit(rng_), 1.0 / (kNoiseGap_bytes - 1.0)));
  next_noise_ += hal::from_seconds(gap_s);
  if (next_noise_ >= noise_until_) {
    next_noise_ = hal::kNever;
  }
}

bool SerialWire::inject(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::DropByte:
      ++drops_;
      return true;
    case FaultKind::CorruptByte:
      ++corruptions_;
      return true;
    case FaultKind::DoubleByte:
      ++doubles_;
      return true;
    case FaultKind::Noise:
      noise_until_ = std::max(noise_until_, fault.at + fault.duration);
      next_noise_ = std::min(next_noise_, fault.at + Stamp(1));
      return true;
    case FaultKind::Stall:
      put_again_from(std::max(busy_until_ > fault.at && line_.empty() ? busy_until_ : Stamp{},
                              fault.at + fault.duration));
      return true;
    default:
      return false;
  }
}

namespace {

constexpr std::size_t kArrivedMax = 65'536;
constexpr std::uint64_t kToHostStream = 0;
constexpr std::uint64_t kToDeviceStream = 1;

}  // namespace

EmulatedPort::EmulatedPort(std::uint64_t seed)
    : to_host_(mix_seed(seed, kToHostStream)), to_device_(mix_seed(seed, kToDeviceStream)) {
}

void EmulatedPort::host_write(std::span<const std::uint8_t> bytes, Stamp now) {
  if (plugged_) {
    to_device_.send(bytes, now, host_baud_);
  }
}

std::size_t EmulatedPort::host_take(std::span<WireByte> into, Stamp until) {
  std::size_t count = 0;
  while (count < into.size() && !arrived_.empty() && arrived_.front().at <= until) {
    into[count++] = arrived_.front();
    arrived_.pop_front();
  }
  return count;
}

Stamp EmulatedPort::next_event() const {
  if (device_ == nullptr) {
    return plug_at_;
  }
  return std::min({plug_at_, device_->next_event(), to_device_.next_arrival(device_->baud())});
}

Stamp EmulatedPort::next_delivery() const {
  return to_host_.next_arrival(host_baud_);
}

void EmulatedPort::advance(Stamp now) {
  run_events(*this, guard_, now, [this](Stamp event) { step(event); });
  if (device_ != nullptr) {
    device_->advance(now);
  }
  deliver(now);
}

void EmulatedPort::step(Stamp event) {
  if (plug_at_ <= event) {
    plug_in();
  }
  if (device_ == nullptr) {
    return;
  }
  device_->advance(event);
  // One at a time: what the device makes of a byte may change its rate.
  if (const auto byte = to_device_.next(event, device_->baud())) {
    device_->receive(byte->value, event);
  }
}

void EmulatedPort::deliver(Stamp now) {
  while (const auto byte = to_host_.next(now, host_baud_)) {
    if (arrived_.size() < kArrivedMax) {
      arrived_.push_back(*byte);
    } else {
      ++overruns_;
    }
  }
}

void EmulatedPort::send(std::span<const std::uint8_t> bytes, Stamp at) {
  if (plugged_ && device_ != nullptr) {
    to_host_.send(bytes, at, device_->baud());
  }
}

bool EmulatedPort::inject(const Fault& fault) {
  deliver(fault.at);
  if (fault.kind == FaultKind::CableOut) {
    pull_cable(fault);
    return true;
  }
  return to_host_.inject(fault) || (device_ != nullptr && device_->inject(fault));
}

void EmulatedPort::plug_in() {
  if (!plugged_) {
    plug_at_ = hal::kNever;
    plugged_ = true;
    ++plug_count_;
  }
}

void EmulatedPort::pull_cable(const Fault& fault) {
  const Stamp until = fault.at + fault.duration;
  plug_at_ = plugged_ ? until : std::max(plug_at_, until);
  plugged_ = false;
  to_host_.clear();
  to_device_.clear();
  arrived_.clear();
}

namespace {

using hal::ByteRead;
using hal::LinkStatus;
using hal::Stamp;

constexpr std::uint32_t kBaudMin = 50;
constexpr std::uint32_t kBaudMax = 4'000'000;
constexpr std::size_t kTakenMax = 256;  // bytes moved at a time

}  // namespace

MemoryLink::MemoryLink(EmulatedPort& port, const SimClock& clock, const MemoryLinkConfig& config)
    : port_(port), clock_(clock), config_(config), timer_(config.reopen) {
}

bool MemoryLink::is_lost() noexcept {
  if (up_ && (!port_.is_plugged() || port_.plug_count() != plug_count_)) {
    up_ = false;
    timer_.lost(clock_.now);
  }
  return !up_;
}

void MemoryLink::service(Stamp now) noexcept {
  if (!is_lost() || !timer_.is_due(now)) {
    return;
  }
  if (!port_.is_plugged()) {
    timer_.failed(now);
    return;
  }
  up_ = true;
  ++epoch_;
  plug_count_ = port_.plug_count();
  timer_.opened(now);
  port_.host_discard();
  port_.set_host_baud(config_.baud);
}

Stamp MemoryLink::handed_over_until() const noexcept {
  return config_.batch > Stamp{} ? clock_.now - clock_.now % config_.batch : clock_.now;
}

ByteRead MemoryLink::read(std::span<std::uint8_t> into) noexcept {
  if (is_lost()) {
    return {LinkStatus::Down, 0, {}};
  }
  std::array<WireByte, kTakenMax> taken;
  std::size_t count = 0;
  while (count < into.size()) {
    const std::size_t room = std::min(into.size() - count, taken.size());
    const std::size_t got = port_.host_take({taken.data(), room}, handed_over_until());
    for (std::size_t i = 0; i < got; ++i) {
      into[count++] = taken[i].value;
    }
    if (got < room) {
      break;
    }
  }
  return {count > 0 ? LinkStatus::Ok : LinkStatus::Busy, count, clock_.now};
}

std::size_t MemoryLink::queued() const noexcept {
  constexpr Stamp::rep kNanosPerByte_baud = 10'000'000'000;  // ten bits
  const Stamp left = std::max(port_.host_busy_until() - clock_.now, Stamp{});
  const Stamp::rep bits = left.count() * static_cast<Stamp::rep>(config_.baud);
  return static_cast<std::size_t>((bits + kNanosPerByte_baud - 1) / kNanosPerByte_baud);
}

LinkStatus MemoryLink::write(std::span<const std::uint8_t> bytes) noexcept {
  if (is_lost()) {
    return LinkStatus::Down;
  }
  if (queued() + bytes.size() > config_.write_queue) {
    return LinkStatus::Busy;
  }
  port_.host_write(bytes, clock_.now);
  return LinkStatus::Ok;
}

LinkStatus MemoryLink::set_baud(std::uint32_t baud) noexcept {
  if (baud < kBaudMin || baud > kBaudMax) {
    return LinkStatus::Down;
  }
  config_.baud = baud;
  if (is_lost()) {
    return LinkStatus::Down;
  }
  port_.set_host_baud(baud);
  return LinkStatus::Ok;
}

void MemoryLink::discard_input() noexcept {
  if (!is_lost()) {
    port_.host_discard();
  }
}

}  // namespace slamsensor::tools
