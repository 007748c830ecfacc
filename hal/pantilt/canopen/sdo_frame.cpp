#include "hal/pantilt/canopen/sdo_frame.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::uint8_t kSdoBytes = 8;
constexpr std::uint8_t kSpecifierMask = 0xE0;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeTold = 0x01;

CanFrame sdo_frame(std::uint8_t node, std::uint8_t specifier, SdoAddress address,
                   std::uint32_t value) noexcept {
  CanFrame frame{.id = cob::kSdoRequest + node, .size = kSdoBytes};
  frame.data[0] = specifier;
  put_le(frame, 1, 2, address.index);
  frame.data[3] = address.sub;
  put_le(frame, 4, 4, value);
  return frame;
}

SdoReply segment_of(const CanFrame& frame) noexcept {
  SdoReply reply;
  reply.kind = SdoReplyKind::Segment;
  const std::uint8_t command = frame.data[0];
  reply.toggle = (command >> 4) & 1;
  reply.last = (command & 1) != 0;
  reply.size = static_cast<std::uint8_t>(7 - ((command >> 1) & 7));
  std::copy_n(frame.data.begin() + 1, reply.size, reply.bytes.begin());
  return reply;
}

void read_upload(const CanFrame& frame, SdoReply& reply) noexcept {
  const std::uint8_t command = frame.data[0];
  const bool told = (command & kSizeTold) != 0;
  if ((command & kExpedited) == 0) {
    reply.kind = SdoReplyKind::LongValue;
    reply.value = told ? le_number(frame, 4, 4) : 0;
    return;
  }
  reply.kind = SdoReplyKind::Value;
  reply.size = static_cast<std::uint8_t>(told ? 4 - ((command >> 2) & 3) : 4);
  reply.value = le_number(frame, 4, reply.size);
}

}  // namespace

CanFrame sdo_write(std::uint8_t node, SdoAddress address, std::uint32_t value, std::uint8_t size) noexcept {
  const std::uint8_t used = std::clamp<std::uint8_t>(size, 1, 4);
  const std::uint32_t kept = used == 4 ? value : value & ((1U << (8U * used)) - 1U);
  return sdo_frame(node, static_cast<std::uint8_t>(0x23 | ((4 - used) << 2)), address, kept);
}

CanFrame sdo_read(std::uint8_t node, SdoAddress address) noexcept {
  return sdo_frame(node, 0x40, address, 0);
}

CanFrame sdo_read_segment(std::uint8_t node, std::uint8_t toggle) noexcept {
  return sdo_frame(node, toggle == 0 ? 0x60 : 0x70, {}, 0);
}

CanFrame sdo_abort(std::uint8_t node, SdoAddress address, std::uint32_t code) noexcept {
  return sdo_frame(node, 0x80, address, code);
}

CanFrame nmt_frame(NmtCommand command, std::uint8_t node) noexcept {
  return {.id = cob::kNmt, .size = 2, .data = {static_cast<std::uint8_t>(command), node}};
}

std::optional<SdoReply> parse_sdo_reply(const CanFrame& frame) noexcept {
  if (frame.size != kSdoBytes) {
    return std::nullopt;
  }
  SdoReply reply;
  reply.address = {static_cast<std::uint16_t>(le_number(frame, 1, 2)), frame.data[3]};
  switch (frame.data[0] & kSpecifierMask) {
    case 0x00:
      return segment_of(frame);
    case 0x40:
      read_upload(frame, reply);
      return reply;
    case 0x60:
      reply.kind = SdoReplyKind::Written;
      return reply;
    case 0x80:
      reply.kind = SdoReplyKind::Abort;
      reply.value = le_number(frame, 4, 4);
      return reply;
    default:
      return std::nullopt;
  }
}

std::uint32_t le_number(const CanFrame& frame, std::size_t offset, std::size_t size) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(size, 4) && offset + i < frame.bytes().size(); ++i) {
    value |= static_cast<std::uint32_t>(frame.data[offset + i]) << (8 * i);
  }
  return value;
}

void put_le(CanFrame& frame, std::size_t offset, std::size_t size, std::uint32_t value) noexcept {
  for (std::size_t i = 0; i < std::min<std::size_t>(size, 4) && offset + i < frame.data.size(); ++i) {
    frame.data[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

}  // namespace slamsensor::hal
