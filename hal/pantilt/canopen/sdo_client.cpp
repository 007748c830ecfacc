#include "hal/pantilt/canopen/sdo_client.hpp"

#include <algorithm>

namespace slamsensor::hal {
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

/// Segments carry no address; only the transfer under way and its toggle bit tell whose they are.
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
