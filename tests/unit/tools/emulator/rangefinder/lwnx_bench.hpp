#pragma once

#include "tests/unit/tools/emulator/rangefinder/bench.hpp"
#include "tools/emulator/rangefinder/emulated_lwnx.hpp"
#include "tools/emulator/rangefinder/lwnx_product.hpp"

namespace slamsensor::tools {

using LwnxBench = Bench<EmulatedLwnx, LwnxSettings>;

inline LwnxSettings ready(LwnxModel model) {
  LwnxSettings settings;
  settings.product = lwnx_product(model);
  settings.begin = DeviceBegin::Ready;
  return settings;
}

/// An SF000 that makes a thousand readings a second.
inline LwnxSettings sf000_at_1_khz() {
  LwnxSettings settings = ready(LwnxModel::Sf000);
  settings.product.rates_hz = {50.0, 1000.0};
  settings.product.find(66)->initial = 2;
  return settings;
}

inline Bytes request(std::uint8_t id, RequestAccess access, const Bytes& data = {}) {
  Bytes packet;
  build_packet(id, access, data, packet);
  return packet;
}

inline Bytes read_request(std::uint8_t id) {
  return request(id, RequestAccess::Read);
}

inline Bytes write_request(std::uint8_t id, std::uint32_t value, std::size_t bytes) {
  Bytes data;
  append_little_endian(value, bytes, data);
  return request(id, RequestAccess::Write, data);
}

/// Payloads (ID and data) of the packets in `bytes`, which hold nothing else.
inline std::vector<Bytes> payloads(const Bytes& bytes) {
  std::vector<Bytes> all;
  for (std::size_t at = 0; at + 6 <= bytes.size();) {
    const std::size_t payload = static_cast<std::size_t>(bytes[at + 2]) * 4 + bytes[at + 1] / 64U;
    EXPECT_EQ(bytes[at], 0xAA);
    if (bytes[at] != 0xAA || at + 5 + payload > bytes.size()) {
      ADD_FAILURE() << "no whole packet at " << at << " of " << hex(bytes);
      return all;
    }
    const std::span<const std::uint8_t> packet(bytes.data() + at, 5 + payload);
    EXPECT_EQ(crc16_xmodem(packet.first(3 + payload)), little_endian(packet.last(2)));
    all.emplace_back(packet.begin() + 3, packet.end() - 2);
    at += 5 + payload;
  }
  return all;
}

/// The signed word of two bytes at `offset` of a payload.
inline int word(const Bytes& payload, std::size_t offset) {
  return static_cast<std::int16_t>(little_endian(std::span(payload).subspan(offset, 2)));
}

/// The token that the device gives out at present.
inline std::uint32_t token(LwnxBench& bench) {
  const auto answer = payloads(bench.say(read_request(10)));
  return answer.size() == 1 ? static_cast<std::uint32_t>(word(answer[0], 1)) & 0xFFFFU : 0;
}

}  // namespace slamsensor::tools
