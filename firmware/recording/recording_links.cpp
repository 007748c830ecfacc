#include "firmware/recording/recording_links.hpp"

#include <algorithm>
#include <bit>

namespace slamsensor::firmware {
namespace {

core::Attitude unpacked(std::uint64_t argument) noexcept {
  const auto half = [](std::uint64_t bits) {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  };
  return {half(argument >> 32U), half(argument)};
}

template <typename Link>
auto* address_of(std::optional<Link>& link) noexcept {
  return link ? &*link : nullptr;
}

}  // namespace

void command(SensorHead& head, TapeCommand what, std::uint64_t argument) noexcept {
  switch (what) {
    case TapeCommand::RequestScan:
      return head.request_scan();
    case TapeCommand::Hold:
      return argument < kHoldReasons ? head.hold(static_cast<HoldReason>(argument)) : void();
    case TapeCommand::Release:
      return argument < kHoldReasons ? head.release(static_cast<HoldReason>(argument)) : void();
    case TapeCommand::SetMode:
      return argument <= static_cast<std::uint64_t>(ScanMode::OneShot)
                 ? head.set_mode(static_cast<ScanMode>(argument))
                 : void();
    case TapeCommand::AbortScan:
      return head.abort_scan();
    case TapeCommand::Incline:
      return head.incline(unpacked(argument));
  }
}

void LinkTape::attach(TapeWriter* tape, const TapeLinkState& state) noexcept {
  tape_ = tape;
  told_ = state;
  if (tape_ != nullptr) {
    tape_->open(link_, state);
  }
}

void LinkTape::note_service(const TapeLinkState& state) noexcept {
  if (state != told_) {
    told_ = state;
    tape_->service(link_, state);
  }
}

void LinkTape::note_call(const TapeLinkState& state) noexcept {
  if (state != told_) {
    told_ = state;
    tape_->after(link_, state);
  }
}

TapeLinkState RecordingByteLink::look() const noexcept {
  return {inner_.epoch(), inner_.is_up(), inner_.baud()};
}

void RecordingByteLink::service(hal::Stamp now) noexcept {
  inner_.service(now);
  if (tape_.get() != nullptr) {
    tape_.note_service(look());
  }
}

hal::ByteRead RecordingByteLink::read(std::span<std::uint8_t> into) noexcept {
  if (tape_.get() == nullptr) {
    return inner_.read(into);
  }
  const auto room = into.first(std::min(into.size(), kTapeBytesMax));
  const hal::ByteRead result = inner_.read(room);
  tape_.get()->read(tape_.link(), result, room.first(std::min(result.count, room.size())));
  tape_.note_call(look());
  return result;
}

hal::LinkStatus RecordingByteLink::write(std::span<const std::uint8_t> bytes) noexcept {
  const hal::LinkStatus status = inner_.write(bytes);
  if (tape_.get() != nullptr) {
    tape_.get()->write(tape_.link(), status, bytes);
    tape_.note_call(look());
  }
  return status;
}

hal::LinkStatus RecordingByteLink::set_baud(std::uint32_t baud) noexcept {
  const hal::LinkStatus status = inner_.set_baud(baud);
  if (tape_.get() != nullptr) {
    tape_.get()->set_baud(tape_.link(), status, baud);
    tape_.note_call(look());
  }
  return status;
}

void RecordingByteLink::discard_input() noexcept {
  inner_.discard_input();
  if (tape_.get() != nullptr) {
    tape_.get()->discard(tape_.link());
    tape_.note_call(look());
  }
}

TapeLinkState RecordingCanLink::look() const noexcept {
  return {inner_.epoch(), inner_.is_up(), 0};
}

void RecordingCanLink::service(hal::Stamp now) noexcept {
  inner_.service(now);
  if (tape_.get() != nullptr) {
    tape_.note_service(look());
  }
}

hal::CanRead RecordingCanLink::receive() noexcept {
  const hal::CanRead result = inner_.receive();
  if (tape_.get() != nullptr) {
    tape_.get()->can_receive(tape_.link(), result);
    tape_.note_call(look());
  }
  return result;
}

hal::LinkStatus RecordingCanLink::send(const hal::CanFrame& frame) noexcept {
  const hal::LinkStatus status = inner_.send(frame);
  if (tape_.get() != nullptr) {
    tape_.get()->can_send(tape_.link(), status, frame);
    tape_.note_call(look());
  }
  return status;
}

RecordingHeadLinks::RecordingHeadLinks(const HeadLinks& inner) noexcept {
  if (inner.pan_tilt_bytes != nullptr) {
    pan_tilt_bytes_.emplace(*inner.pan_tilt_bytes, HeadLink::PanTiltBytes);
  }
  if (inner.pan_tilt_can != nullptr) {
    pan_tilt_can_.emplace(*inner.pan_tilt_can, HeadLink::PanTiltCan);
  }
  if (inner.rangefinder_bytes != nullptr) {
    rangefinder_bytes_.emplace(*inner.rangefinder_bytes, HeadLink::RangefinderBytes);
  }
  if (inner.rangefinder_can != nullptr) {
    rangefinder_can_.emplace(*inner.rangefinder_can, HeadLink::RangefinderCan);
  }
}

HeadLinks RecordingHeadLinks::get() noexcept {
  return {address_of(pan_tilt_bytes_), address_of(pan_tilt_can_), address_of(rangefinder_bytes_),
          address_of(rangefinder_can_)};
}

void RecordingHeadLinks::attach(TapeWriter* tape) noexcept {
  const auto attach_one = [tape](auto& link) {
    if (link) {
      link->attach(tape);
    }
  };
  attach_one(pan_tilt_bytes_);
  attach_one(pan_tilt_can_);
  attach_one(rangefinder_bytes_);
  attach_one(rangefinder_can_);
}

}  // namespace slamsensor::firmware
