#include "firmware/recording/tape_writer.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kNumberBytesMax = 10;  // of 64 bits, seven to a byte
constexpr std::size_t kNumbersMax = 4;
constexpr std::size_t kHeadBytesMax = 1 + kNumbersMax * kNumberBytesMax;
constexpr std::size_t kEndBytes = 1;

// A loss is noted at the start of a chunk, before the operation that begins it.
static_assert(2 * kHeadBytesMax + kTapeBytesMax + kEndBytes <= kTapeChunkBytes);

constexpr HeadLink kNoLink{};

}  // namespace

TapeWriter::TapeWriter(TapeSink& sink) : sink_(sink), chunk_(std::make_unique<TapeChunk>()) {
}

void TapeWriter::begin(TapeOp op, HeadLink link, std::size_t bytes) noexcept {
  if (chunk_->size + kHeadBytesMax + bytes + kEndBytes > kTapeChunkBytes) {
    hand_out();
  }
  if (lost_ > lost_told_) {
    put(static_cast<std::uint8_t>(static_cast<unsigned>(TapeOp::Lost) << 4U));
    number(lost_ - lost_told_);
    lost_told_ = lost_;
  }
  put(static_cast<std::uint8_t>((static_cast<unsigned>(op) << 4U) | static_cast<unsigned>(link)));
  ++operations_;
}

void TapeWriter::hand_out() noexcept {
  lost_ += sink_.take(*chunk_) ? 0 : operations_;
  ++chunk_->number;
  chunk_->size = 0;
  operations_ = 0;
  is_first_step_ = true;
}

void TapeWriter::number(std::uint64_t value) noexcept {
  while (value >= 0x80U) {
    put(static_cast<std::uint8_t>(value | 0x80U));
    value >>= 7U;
  }
  put(static_cast<std::uint8_t>(value));
}

void TapeWriter::signed_number(std::int64_t value) noexcept {
  number((static_cast<std::uint64_t>(value) << 1U) ^ static_cast<std::uint64_t>(value >> 63));
}

void TapeWriter::bytes(std::span<const std::uint8_t> data) noexcept {
  std::copy(data.begin(), data.end(), chunk_->data.begin() + chunk_->size);
  chunk_->size += static_cast<std::uint32_t>(data.size());
}

void TapeWriter::state(const TapeLinkState& state) noexcept {
  number(state.epoch);
  number(state.is_up ? 1 : 0);
  number(state.baud);
}

void TapeWriter::frame(const hal::CanFrame& frame) noexcept {
  number(frame.id);
  number((frame.extended ? 1U : 0U) + 2U * frame.bytes().size());
  bytes(frame.bytes());
}

void TapeWriter::open(HeadLink link, const TapeLinkState& link_state) noexcept {
  begin(TapeOp::Open, link, 0);
  state(link_state);
}

void TapeWriter::step(hal::Stamp now) noexcept {
  begin(TapeOp::Step, kNoLink, 0);
  const hal::Stamp period = now - now_;
  if (is_first_step_) {
    number(static_cast<std::uint64_t>(now.count()));
  } else {
    signed_number((period - period_).count());
  }
  now_ = now;
  period_ = period;
  is_first_step_ = false;
}

void TapeWriter::service(HeadLink link, const TapeLinkState& link_state) noexcept {
  begin(TapeOp::Service, link, 0);
  state(link_state);
}

void TapeWriter::after(HeadLink link, const TapeLinkState& link_state) noexcept {
  begin(TapeOp::After, link, 0);
  state(link_state);
}

void TapeWriter::read(HeadLink link, const hal::ByteRead& result,
                      std::span<const std::uint8_t> data) noexcept {
  if (result.status != hal::LinkStatus::Ok) {
    begin(result.status == hal::LinkStatus::Busy ? TapeOp::ReadBusy : TapeOp::ReadDown, link, 0);
    return;
  }
  const auto kept = data.first(std::min(data.size(), kTapeBytesMax));
  begin(TapeOp::ReadOk, link, kept.size());
  signed_number((result.stamp - now_).count());
  number(kept.size());
  bytes(kept);
}

void TapeWriter::write(HeadLink link, hal::LinkStatus status, std::span<const std::uint8_t> data) noexcept {
  const auto kept = data.first(std::min(data.size(), kTapeBytesMax));
  begin(TapeOp::Write, link, kept.size());
  number(static_cast<std::uint64_t>(status));
  number(kept.size());
  bytes(kept);
}

void TapeWriter::set_baud(HeadLink link, hal::LinkStatus status, std::uint32_t baud) noexcept {
  begin(TapeOp::SetBaud, link, 0);
  number(static_cast<std::uint64_t>(status));
  number(baud);
}

void TapeWriter::discard(HeadLink link) noexcept {
  begin(TapeOp::Discard, link, 0);
}

void TapeWriter::can_receive(HeadLink link, const hal::CanRead& result) noexcept {
  if (result.status != hal::LinkStatus::Ok) {
    begin(result.status == hal::LinkStatus::Busy ? TapeOp::ReadBusy : TapeOp::ReadDown, link, 0);
    return;
  }
  begin(TapeOp::CanReceive, link, result.frame.bytes().size());
  signed_number((result.stamp - now_).count());
  frame(result.frame);
}

void TapeWriter::can_send(HeadLink link, hal::LinkStatus status, const hal::CanFrame& sent) noexcept {
  begin(TapeOp::CanSend, link, sent.bytes().size());
  number(static_cast<std::uint64_t>(status));
  frame(sent);
}

void TapeWriter::command(TapeCommand what, std::uint64_t argument) noexcept {
  begin(TapeOp::Command, kNoLink, 0);
  number(static_cast<std::uint64_t>(what));
  number(argument);
}

bool TapeWriter::finish() noexcept {
  if (!has_ended_) {
    begin(TapeOp::End, kNoLink, 0);
    has_ended_ = true;
  }
  return sink_.take(*chunk_);
}

}  // namespace slamsensor::firmware
