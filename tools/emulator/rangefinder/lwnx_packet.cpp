#include "tools/emulator/rangefinder/lwnx_packet.hpp"

#include "tools/emulator/rangefinder/crc16_xmodem.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr std::uint8_t kStart = 0xAA;
constexpr std::size_t kHeaderBytes = 3;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kPayloadMax = 160;  // the longest request is a page of firmware: 131
constexpr hal::Stamp kPause = std::chrono::milliseconds(100);

}  // namespace

void append_little_endian(std::int64_t value, std::size_t bytes, std::vector<std::uint8_t>& data) {
  auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < bytes; ++i) {
    data.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
    bits >>= 8U;
  }
}

std::uint64_t little_endian(std::span<const std::uint8_t> data) {
  std::uint64_t value = 0;
  for (std::size_t i = std::min<std::size_t>(data.size(), 8); i > 0; --i) {
    value = value << 8U | data[i - 1];
  }
  return value;
}

void build_packet(std::uint8_t id, LwnxAccess access, std::span<const std::uint8_t> data,
                  std::vector<std::uint8_t>& packet) {
  const auto length = static_cast<std::int64_t>(data.size() + 1);
  packet.clear();
  packet.push_back(kStart);
  append_little_endian(length * 64 + (access == LwnxAccess::Write ? 1 : 0), 2, packet);
  packet.push_back(id);
  packet.insert(packet.end(), data.begin(), data.end());
  append_little_endian(crc16_xmodem(packet), kCrcBytes, packet);
}

std::optional<LwnxRequest> LwnxReceiver::push(std::uint8_t byte, hal::Stamp at) {
  if (at - last_byte_ > kPause) {
    buffer_.clear();
  }
  last_byte_ = at;
  if (buffer_.empty() && byte != kStart) {
    return std::nullopt;
  }
  buffer_.push_back(byte);
  return take_request();
}

std::optional<LwnxRequest> LwnxReceiver::take_request() {
  while (buffer_.size() >= kHeaderBytes) {
    const std::size_t whole = packet_bytes();
    if (whole != 0 && buffer_.size() < whole) {
      return std::nullopt;
    }
    const std::span<const std::uint8_t> packet(buffer_.data(), whole);
    if (whole == 0 ||
        crc16_xmodem(packet.first(whole - kCrcBytes)) != little_endian(packet.last(kCrcBytes))) {
      ++refused_;
      skip_false_start();
      continue;
    }
    LwnxRequest request;
    request.id = packet[kHeaderBytes];
    request.access = (packet[1] & 1U) != 0 ? LwnxAccess::Write : LwnxAccess::Read;
    request.data.assign(packet.begin() + kHeaderBytes + 1, packet.end() - kCrcBytes);
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(whole));
    return request;
  }
  return std::nullopt;
}

std::size_t LwnxReceiver::packet_bytes() const {
  const std::size_t payload = static_cast<std::size_t>(buffer_[2]) * 4 + buffer_[1] / 64U;
  return payload == 0 || payload > kPayloadMax ? 0 : kHeaderBytes + payload + kCrcBytes;
}

void LwnxReceiver::skip_false_start() {
  buffer_.erase(buffer_.begin(), std::find(buffer_.begin() + 1, buffer_.end(), kStart));
}

}  // namespace slamsensor::tools
