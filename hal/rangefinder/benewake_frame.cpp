#include "hal/rangefinder/benewake_frame.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::hal {
namespace {

// As signed words: -1 too weak, -2 saturated, -4 blinded by ambient light.
constexpr std::array kMiniCodes = {RangeCode{0xFFFF, Echo::None}, RangeCode{0xFFFE, Echo::Saturated},
                                   RangeCode{0xFFFC, Echo::Fault}};
constexpr std::uint16_t kOverexposed =
    0xFFFF;  // as strength: the echo was too strong, whatever the distance says
constexpr std::uint16_t kFirstCode = 0x8000;  // no member of the family measures 327 m
constexpr std::uint8_t kReliableFrom = 7;
constexpr std::uint8_t kReliableTo = 8;

constexpr std::array kProducts = {
    BenewakeProduct{.name = "Benewake TF03",
                    .commands = BenewakeCommands::OverRange,
                    .rate_max_hz = 10000.0,
                    .weak_below = 40.0},
    BenewakeProduct{.name = "Benewake TFmini",
                    .commands = BenewakeCommands::None,
                    .rate_max_hz = 100.0,
                    .weak_below = 20.0,
                    .codes = kMiniCodes},
    BenewakeProduct{.name = "Benewake TFmini Plus", .weak_below = 100.0, .codes = kMiniCodes},
    BenewakeProduct{.name = "Benewake TFmini-S", .weak_below = 100.0, .codes = kMiniCodes},
    BenewakeProduct{.name = "Benewake TF02",
                    .commands = BenewakeCommands::None,
                    .rate_max_hz = 100.0,
                    .codes = kMiniCodes,
                    .has_reliability = true}};

}  // namespace

const BenewakeProduct& benewake_product(BenewakeModel model) noexcept {
  return kProducts[static_cast<std::size_t>(model)];
}

Measurement measured(const BenewakeReading& reading, const BenewakeProduct& product,
                     std::uint16_t over_range_cm) noexcept {
  Measurement out{.range_m = reading.distance_cm * 0.01, .strength = static_cast<double>(reading.strength)};
  for (const RangeCode& code : product.codes) {
    if (reading.distance_cm == code.word) {
      out.echo = code.echo;
    }
  }
  if (reading.strength == kOverexposed && out.echo != Echo::Fault) {
    out.echo = Echo::Saturated;
  }
  if (out.echo != Echo::Return) {
    return out;
  }
  if (reading.distance_cm == 0 || (over_range_cm > 0 && reading.distance_cm >= over_range_cm)) {
    out.echo = Echo::None;
  } else if (reading.distance_cm >= kFirstCode) {
    out.echo = Echo::Fault;
  } else if (product.has_reliability &&
             (reading.reliability < kReliableFrom || reading.reliability > kReliableTo)) {
    out.echo = Echo::Weak;
  }
  return out;
}

std::uint8_t benewake_checksum(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : bytes) {
    sum += byte;
  }
  return static_cast<std::uint8_t>(sum & 0xFF);
}

std::size_t write_benewake(std::uint8_t id, std::span<const std::uint8_t> payload,
                           std::span<std::uint8_t> into) noexcept {
  const std::size_t size = payload.size() + kBenewakeCommandMin;
  if (size > kBenewakeCommandMax || size > into.size()) {
    return 0;
  }
  into[0] = kBenewakeCommand;
  into[1] = static_cast<std::uint8_t>(size);
  into[2] = id;
  std::copy(payload.begin(), payload.end(), into.begin() + 3);
  into[size - 1] = benewake_checksum(into.first(size - 1));
  return size;
}

bool is_benewake_command(std::span<const std::uint8_t> bytes) noexcept {
  return bytes.size() >= kBenewakeCommandMin && bytes.size() <= kBenewakeCommandMax &&
         bytes[0] == kBenewakeCommand && bytes[1] == bytes.size() &&
         benewake_checksum(bytes.first(bytes.size() - 1)) == bytes.back();
}

std::optional<BenewakeReading> read_benewake_can(std::span<const std::uint8_t> data) noexcept {
  constexpr std::size_t kReadingBytes = 4;
  if (data.size() < kReadingBytes) {
    return std::nullopt;
  }
  return BenewakeReading{static_cast<std::uint16_t>(data[0] | data[1] << 8),
                         static_cast<std::uint16_t>(data[2] | data[3] << 8),
                         data.size() > kReadingBytes ? data[4] : std::uint8_t{0}};
}

std::span<const std::uint8_t> benewake_reply_in(std::span<const std::uint8_t> data) noexcept {
  if (data.size() < kBenewakeCommandMin || data[1] > data.size()) {
    return {};
  }
  const auto reply = data.first(data[1]);
  return is_benewake_command(reply) ? reply : std::span<const std::uint8_t>{};
}

BenewakeParser::Found BenewakeParser::push(std::uint8_t byte) noexcept {
  std::copy(tail_.begin() + 1, tail_.end(), tail_.begin());
  tail_.back() = byte;
  bytes_[size_++] = byte;  // follow() and search() leave room for one
  ++position_;
  Found found;
  found.has_reading = follow() || search();
  found.has_reply = find_reply();
  return found;
}

bool BenewakeParser::is_frame_at(std::size_t at) const noexcept {
  const auto frame = std::span(bytes_).subspan(at, kBenewakeFrame);
  return frame[0] == kBenewakeData && frame[1] == kBenewakeData &&
         benewake_checksum(frame.first(kBenewakeFrame - 1)) == frame.back();
}

/// Whether what begins at `at` can be a frame or a reply.
BenewakeParser::Successor BenewakeParser::successor(std::size_t at) const noexcept {
  if (size_ <= at) {
    return Successor::Awaited;
  }
  if (bytes_[at] != kBenewakeData && bytes_[at] != kBenewakeCommand) {
    return Successor::Foreign;
  }
  if (size_ == at + 1) {
    return Successor::Awaited;
  }
  const std::uint8_t second = bytes_[at + 1];
  const bool fits = bytes_[at] == kBenewakeData
                        ? second == kBenewakeData
                        : second >= kBenewakeCommandMin && second <= kBenewakeCommandMax;
  return fits ? Successor::Fits : Successor::Foreign;
}

/// In step with the device: what follows must be a frame or a reply.
bool BenewakeParser::follow() noexcept {
  if (!is_locked_) {
    return false;
  }
  switch (successor(0)) {
    case Successor::Awaited:
      return false;
    case Successor::Foreign:
      lose();
      return false;
    case Successor::Fits:
      break;
  }
  if (bytes_[0] == kBenewakeCommand) {
    follow_reply();
    return false;
  }
  return follow_frame();
}

void BenewakeParser::follow_reply() noexcept {
  const std::size_t size = bytes_[1];
  if (size_ >= size) {
    is_benewake_command(std::span(bytes_).first(size)) ? drop(size) : lose();
  }
}

bool BenewakeParser::follow_frame() noexcept {
  if (size_ < kBenewakeFrame) {
    return false;
  }
  if (!is_frame_at(0)) {
    counters_.count(RangeEvent::ChecksumErrors);
    lose();
    return false;
  }
  switch (successor(kBenewakeFrame)) {
    case Successor::Awaited:
      return false;
    case Successor::Foreign:
      counters_.count(RangeEvent::RecordsRefused);
      lose();
      return false;
    case Successor::Fits:
      break;
  }
  take_frame(0);
  return true;
}

BenewakeParser::Found BenewakeParser::pause() noexcept {
  Found found;
  if (is_locked_ && size_ == kBenewakeFrame && is_frame_at(0)) {
    take_frame(0);
    found.has_reading = true;
  }
  return found;
}

bool BenewakeParser::search() noexcept {
  while (!is_locked_ && size_ > 0) {
    if (bytes_[0] != kBenewakeData || (size_ > 1 && bytes_[1] != kBenewakeData)) {
      skip_byte();
      continue;
    }
    if (size_ < kBenewakeFrame) {
      return false;
    }
    if (!is_frame_at(0)) {
      skip_byte();
      continue;
    }
    if (size_ < kSearch) {
      return false;
    }
    const bool fits = is_frame_at(kBenewakeFrame) && successor(2 * kBenewakeFrame) == Successor::Fits;
    if (!fits || is_ambiguous()) {
      skip_byte();
      continue;
    }
    counters_.count(RangeEvent::ReadingsWithheld);
    take_frame(kBenewakeFrame);
    is_locked_ = true;
    return true;
  }
  return false;
}

bool BenewakeParser::is_ambiguous() const noexcept {
  for (std::size_t at = 1; at < kBenewakeFrame; ++at) {
    if (is_frame_at(at) && is_frame_at(at + kBenewakeFrame)) {
      return true;
    }
  }
  return false;
}

/// A reply may come at any place, also while data frames are not found; its own checksum and the driver's
/// comparison with what was asked guard it.
bool BenewakeParser::find_reply() noexcept {
  const std::size_t longest = std::min<std::uint64_t>(position_, tail_.size());
  for (std::size_t size = kBenewakeCommandMin; size <= longest; ++size) {
    if (is_benewake_command(std::span(tail_).last(size))) {
      reply_size_ = size;
      return true;
    }
  }
  return false;
}

void BenewakeParser::take_frame(std::size_t at) noexcept {
  const auto word = [&](std::size_t i) {
    return static_cast<std::uint16_t>(bytes_[at + i] | bytes_[at + i + 1] << 8);
  };
  reading_ = {word(2), word(4), bytes_[at + 6]};
  reading_end_ = position_ - size_ + at + kBenewakeFrame;
  drop(at + kBenewakeFrame);
}

void BenewakeParser::drop(std::size_t count) noexcept {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(count),
            bytes_.begin() + static_cast<std::ptrdiff_t>(size_), bytes_.begin());
  size_ -= count;
}

void BenewakeParser::skip_byte() noexcept {
  counters_.count(RangeEvent::BytesSkipped);
  drop(1);
}

void BenewakeParser::lose() noexcept {
  counters_.count(RangeEvent::LocksLost);
  is_locked_ = false;
}

}  // namespace slamsensor::hal
