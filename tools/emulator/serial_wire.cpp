#include "tools/emulator/serial_wire.hpp"

#include <algorithm>
#include <utility>

namespace slamsensor::tools {
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

}  // namespace slamsensor::tools
