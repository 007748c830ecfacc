#include "firmware/recording/tape_writer.hpp"

namespace slamsensor::firmware {
namespace {

// A step may go on past the length at which a chunk is due: room for what one step of all links can carry.
constexpr std::size_t kCapacity = kTapeChunkBytes + 16 * kTapeBytesMax;
constexpr std::size_t kNumbersMax = 3 * 10;  // three LEB128 of 64 bits

}  // namespace

TapeWriter::TapeWriter() {
  chunk_.reserve(kCapacity);
}

bool TapeWriter::begin(TapeOp op, std::uint8_t link, std::size_t bytes) noexcept {
  if (lost_ > 0 || link >= kTapeLinks || bytes > kTapeBytesMax ||
      chunk_.size() + 1 + kNumbersMax + bytes > kCapacity) {
    ++lost_;
    return false;
  }
  chunk_.push_back(static_cast<std::uint8_t>((static_cast<unsigned>(op) << 4U) | link));
  return true;
}

void TapeWriter::number(std::uint64_t value) noexcept {
  while (value >= 0x80U) {
    chunk_.push_back(static_cast<std::uint8_t>(value | 0x80U));
    value >>= 7U;
  }
  chunk_.push_back(static_cast<std::uint8_t>(value));
}

void TapeWriter::signed_number(std::int64_t value) noexcept {
  number((static_cast<std::uint64_t>(value) << 1U) ^ static_cast<std::uint64_t>(value >> 63));
}

void TapeWriter::bytes(std::span<const std::uint8_t> data) noexcept {
  chunk_.insert(chunk_.end(), data.begin(), data.end());
}

void TapeWriter::frame(const hal::CanFrame& frame) noexcept {
  number(frame.id);
  number((frame.extended ? 1U : 0U) + 2U * frame.bytes().size());
  bytes(frame.bytes());
}

void TapeWriter::step(hal::Stamp now) noexcept {
  if (begin(TapeOp::Step, 0, 0)) {
    number(static_cast<std::uint64_t>((is_fresh_ ? now : now - now_).count()));
  }
  now_ = now;
  is_fresh_ = false;
}

void TapeWriter::link_state(std::uint8_t link, std::uint32_t epoch, bool is_up) noexcept {
  if (begin(TapeOp::LinkState, link, 0)) {
    number(epoch);
    number(is_up ? 1 : 0);
  }
}

void TapeWriter::read(std::uint8_t link, const hal::ByteRead& result,
                      std::span<const std::uint8_t> data) noexcept {
  if (result.status != hal::LinkStatus::Ok) {
    static_cast<void>(begin(TapeOp::ReadBusy, link, 0));
    return;
  }
  if (begin(TapeOp::ReadOk, link, data.size())) {
    signed_number((result.stamp - now_).count());
    number(data.size());
    bytes(data);
  }
}

void TapeWriter::read_down(std::uint8_t link, std::uint32_t epoch, bool is_up) noexcept {
  if (begin(TapeOp::ReadDown, link, 0)) {
    number(epoch);
    number(is_up ? 1 : 0);
  }
}

void TapeWriter::write(std::uint8_t link, hal::LinkStatus status,
                       std::span<const std::uint8_t> data) noexcept {
  if (begin(TapeOp::Write, link, data.size())) {
    number(static_cast<std::uint64_t>(status));
    number(data.size());
    bytes(data);
  }
}

void TapeWriter::set_baud(std::uint8_t link, hal::LinkStatus status, std::uint32_t baud) noexcept {
  if (begin(TapeOp::SetBaud, link, 0)) {
    number(static_cast<std::uint64_t>(status));
    number(baud);
  }
}

void TapeWriter::discard(std::uint8_t link) noexcept {
  static_cast<void>(begin(TapeOp::Discard, link, 0));
}

void TapeWriter::can_receive(std::uint8_t link, const hal::CanRead& result) noexcept {
  if (result.status != hal::LinkStatus::Ok) {
    static_cast<void>(begin(TapeOp::ReadBusy, link, 0));
    return;
  }
  if (begin(TapeOp::CanReceive, link, result.frame.bytes().size())) {
    signed_number((result.stamp - now_).count());
    frame(result.frame);
  }
}

void TapeWriter::can_send(std::uint8_t link, hal::LinkStatus status, const hal::CanFrame& sent) noexcept {
  if (begin(TapeOp::CanSend, link, sent.bytes().size())) {
    number(static_cast<std::uint64_t>(status));
    frame(sent);
  }
}

void TapeWriter::clear() noexcept {
  chunk_.clear();
  is_fresh_ = true;
}

}  // namespace slamsensor::firmware
