#include "hal/pantilt/canopen/sdo_client.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr std::uint8_t kSdoBytes = 8;
constexpr std::uint8_t kSpecifierMask = 0xE0;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeIndicated = 0x01;

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
  const bool has_size = (command & kSizeIndicated) != 0;
  if ((command & kExpedited) == 0) {
    reply.kind = SdoReplyKind::LongValue;
    reply.value = has_size ? le_number(frame, 4, 4) : 0;
    return;
  }
  reply.kind = SdoReplyKind::Value;
  reply.size = static_cast<std::uint8_t>(has_size ? 4 - ((command >> 2) & 3) : 4);
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

namespace {

constexpr std::uint32_t kAbortToggle = 0x05030000;
constexpr std::uint32_t kAbortTimeout = 0x05040000;
constexpr std::uint32_t kAbortMemory = 0x05040005;
constexpr std::size_t kSegmentsMax = 64;  // of a text; more is no name

}  // namespace

std::int32_t SdoResult::signed_value() const noexcept {
  switch (size) {
    case 1:
      return static_cast<std::int8_t>(value);
    case 2:
      return static_cast<std::int16_t>(value);
    default:
      return static_cast<std::int32_t>(value);
  }
}

void SdoClient::reset() noexcept {
  phase_ = Phase::Idle;
  unsent_ = false;
  suspect_ = false;
}

void SdoClient::begin(const SdoRequest& request, Stamp now) noexcept {
  if (!is_idle()) {
    return;
  }
  result_ = {};
  result_.request = request;
  attempts_ = 0;
  if (suspect_) {
    send_marker(now);
  } else {
    send_request(now);
  }
}

void SdoClient::step(Stamp now) noexcept {
  if (phase_ == Phase::Idle || phase_ == Phase::Finished) {
    return;
  }
  if (unsent_) {
    send(outgoing_, now);
  }
  if (now < deadline_) {
    return;
  }
  counters_.count(CanopenEvent::SdoTimeouts);
  suspect_ = true;
  if (phase_ == Phase::Segments) {
    send(sdo_abort(node_, result_.request.address, kAbortTimeout), now);
  }
  if (++attempts_ >= config_.sdo_attempts) {
    finish(SdoOutcome::TimedOut, 0, now);
    return;
  }
  counters_.count(CanopenEvent::SdoRepeats);
  send_marker(now);
}

void SdoClient::on_frame(const CanRead& got, Stamp now) noexcept {
  const std::optional<SdoReply> reply = parse_sdo_reply(got.frame);
  if (!reply) {
    counters_.count(CanopenEvent::FramesMalformed);
    return;
  }
  if (reply->kind == SdoReplyKind::Segment) {
    on_segment(*reply, got, now);
    return;
  }
  const bool waits = phase_ == Phase::Marker || phase_ == Phase::Request || phase_ == Phase::Segments;
  const SdoAddress expected = phase_ == Phase::Marker ? marker() : result_.request.address;
  if (!waits || unsent_ || reply->address != expected) {
    counters_.count(CanopenEvent::SdoRepliesForeign);
    return;
  }
  on_reply(*reply, got, now);
}

std::optional<SdoResult> SdoClient::take() noexcept {
  if (phase_ != Phase::Finished) {
    return std::nullopt;
  }
  phase_ = Phase::Idle;
  return result_;
}

DeviceName SdoClient::text() const noexcept {
  const std::string_view all(text_.data(), text_size_);
  return DeviceName(all.substr(0, all.find('\0')));
}

void SdoClient::send(const CanFrame& frame, Stamp now) noexcept {
  outgoing_ = frame;
  unsent_ = link_.send(frame) != LinkStatus::Ok;
  counters_.count(CanopenEvent::SendsBusy, unsent_ ? 1 : 0);
  if (!unsent_) {
    result_.sent = now;
    deadline_ = now + config_.sdo_timeout;
  }
}

void SdoClient::send_request(Stamp now) noexcept {
  const SdoRequest& request = result_.request;
  phase_ = Phase::Request;
  toggle_ = 0;
  text_size_ = 0;
  segments_ = 0;
  deadline_ = now + config_.sdo_timeout;
  send(request.kind == SdoRequest::Kind::Write
           ? sdo_write(node_, request.address, request.value, request.size)
           : sdo_read(node_, request.address),
       now);
}

void SdoClient::send_marker(Stamp now) noexcept {
  phase_ = Phase::Marker;
  deadline_ = now + config_.sdo_timeout;
  send(sdo_read(node_, marker()), now);
}

/// Segments carry no address; only the transfer under way and its toggle bit show whose they are.
void SdoClient::on_segment(const SdoReply& reply, const CanRead& got, Stamp now) noexcept {
  if (phase_ != Phase::Segments || unsent_) {
    counters_.count(CanopenEvent::SdoRepliesForeign);
    return;
  }
  const bool toggled = reply.toggle == toggle_;
  if (!toggled || ++segments_ > kSegmentsMax) {
    counters_.count(CanopenEvent::FramesMalformed);
    const std::uint32_t code = toggled ? kAbortMemory : kAbortToggle;
    suspect_ = true;
    send(sdo_abort(node_, result_.request.address, code), now);
    finish(SdoOutcome::Aborted, code, got.stamp);
    return;
  }
  const std::size_t count = std::min<std::size_t>(reply.size, text_.size() - text_size_);
  std::transform(reply.bytes.begin(), reply.bytes.begin() + static_cast<std::ptrdiff_t>(count),
                 text_.begin() + static_cast<std::ptrdiff_t>(text_size_),
                 [](std::uint8_t byte) { return static_cast<char>(byte); });
  text_size_ += count;
  if (reply.last) {
    finish(SdoOutcome::Done, 0, got.stamp);
    return;
  }
  toggle_ ^= 1;
  send(sdo_read_segment(node_, toggle_), now);
}

void SdoClient::on_reply(const SdoReply& reply, const CanRead& got, Stamp now) noexcept {
  if (phase_ == Phase::Marker) {
    suspect_ = false;
    send_request(now);
    return;
  }
  if (reply.kind == SdoReplyKind::Abort) {
    counters_.count(CanopenEvent::SdoAborts);
    finish(SdoOutcome::Aborted, reply.value, got.stamp);
    return;
  }
  const bool writing = result_.request.kind == SdoRequest::Kind::Write;
  if (phase_ == Phase::Segments || writing != (reply.kind == SdoReplyKind::Written)) {
    counters_.count(CanopenEvent::SdoRepliesForeign);
    return;
  }
  if (reply.kind == SdoReplyKind::LongValue && result_.request.kind == SdoRequest::Kind::ReadText) {
    phase_ = Phase::Segments;
    send(sdo_read_segment(node_, toggle_), now);
    return;
  }
  if (reply.kind == SdoReplyKind::LongValue) {
    // No number is that long: the transfer is of no use and must be ended.
    send(sdo_abort(node_, result_.request.address, kAbortMemory), now);
    finish(SdoOutcome::Aborted, kAbortMemory, got.stamp);
    return;
  }
  keep_expedited(reply);
  finish(SdoOutcome::Done, reply.value, got.stamp);
}

/// A name of up to 4 characters comes in one frame.
void SdoClient::keep_expedited(const SdoReply& reply) noexcept {
  result_.size = reply.size;
  text_size_ = reply.kind == SdoReplyKind::Value ? std::min<std::size_t>(reply.size, 4) : 0;
  for (std::size_t i = 0; i < text_size_; ++i) {
    text_[i] = static_cast<char>((reply.value >> (8 * i)) & 0xFFU);
  }
}

void SdoClient::finish(SdoOutcome outcome, std::uint32_t value, Stamp received) noexcept {
  result_.outcome = outcome;
  result_.value = value;
  result_.received = received;
  phase_ = Phase::Finished;
  unsent_ = false;
}

SdoAddress SdoClient::marker() const noexcept {
  return result_.request.address == object::kErrorRegister ? object::kDeviceType : object::kErrorRegister;
}

}  // namespace slamsensor::hal
