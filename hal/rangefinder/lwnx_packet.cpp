#include "hal/rangefinder/lwnx_packet.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kHeader = 3;
constexpr std::size_t kCrc = 2;
constexpr std::uint32_t kReservedFlags = 0x3E;

std::uint32_t word(std::uint8_t low, std::uint8_t high) noexcept {
  return static_cast<std::uint32_t>(low) | static_cast<std::uint32_t>(high) << 8;
}

}  // namespace

std::size_t write_lwnx(std::uint8_t id, LwnxAccess access, std::span<const std::uint8_t> data,
                       std::span<std::uint8_t> into) noexcept {
  const std::size_t payload = data.size() + 1;
  if (payload > kLwnxPayloadMax || into.size() < payload + kLwnxOverhead) {
    return 0;
  }
  const auto flags = static_cast<std::uint32_t>(payload << 6) | (access == LwnxAccess::Write ? 1u : 0u);
  into[0] = kLwnxStart;
  into[1] = static_cast<std::uint8_t>(flags & 0xFF);
  into[2] = static_cast<std::uint8_t>(flags >> 8);
  into[kHeader] = id;
  std::copy(data.begin(), data.end(), into.begin() + kHeader + 1);
  const std::uint16_t crc = crc16_xmodem(into.first(kHeader + payload));
  into[kHeader + payload] = static_cast<std::uint8_t>(crc & 0xFF);
  into[kHeader + payload + 1] = static_cast<std::uint8_t>(crc >> 8);
  return payload + kLwnxOverhead;
}

void LwnxParser::push(std::uint8_t byte) noexcept {
  drop(used_);
  if (size_ == bytes_.size()) {
    drop(1);  // only when next() was not called
    counters_.count(RangeEvent::BytesSkipped);
  }
  bytes_[size_++] = byte;
  ++position_;
}

LwnxParser::Look LwnxParser::look(std::span<const std::uint8_t> bytes, std::size_t& size) noexcept {
  if (bytes[0] != kLwnxStart) {
    return Look::Nothing;
  }
  if (bytes.size() < kHeader) {
    return Look::Incomplete;
  }
  const std::uint32_t flags = word(bytes[1], bytes[2]);
  const std::size_t payload = flags >> 6;
  if (payload < 1 || payload > kLwnxPayloadMax || (flags & kReservedFlags) != 0) {
    counters_.count(RangeEvent::LengthsRefused);
    return Look::Nothing;
  }
  size = payload + kLwnxOverhead;
  if (bytes.size() < size) {
    return Look::Incomplete;
  }
  if (crc16_xmodem(bytes.first(size - kCrc)) != word(bytes[size - 2], bytes[size - 1])) {
    counters_.count(RangeEvent::ChecksumErrors);
    return Look::Nothing;
  }
  return Look::Packet;
}

std::optional<LwnxPacket> LwnxParser::next() noexcept {
  drop(used_);
  for (std::size_t at = 0; at < size_; ++at) {
    std::size_t size = 0;
    const Look seen = look({bytes_.data() + at, size_ - at}, size);
    if (seen == Look::Nothing) {
      continue;
    }
    counters_.count(RangeEvent::BytesSkipped, at);
    drop(at);
    if (seen == Look::Incomplete) {
      return std::nullopt;
    }
    used_ = size;
    const std::uint64_t begin = position_ - size_;
    return LwnxPacket{
        bytes_[kHeader], {bytes_.data() + kHeader + 1, size - kLwnxOverhead - 1}, begin, begin + size};
  }
  counters_.count(RangeEvent::BytesSkipped, size_);
  drop(size_);
  return std::nullopt;
}

void LwnxParser::give_up() noexcept {
  drop(used_);
  if (size_ > 0) {
    counters_.count(RangeEvent::BytesSkipped);
    drop(1);
  }
}

void LwnxParser::drop(std::size_t count) noexcept {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(count),
            bytes_.begin() + static_cast<std::ptrdiff_t>(size_), bytes_.begin());
  size_ -= count;
  used_ = 0;
}

}  // namespace slamsensor::hal
