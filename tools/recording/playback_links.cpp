#include "tools/recording/playback_links.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

using firmware::HeadLink;
using firmware::TapeOp;
using hal::LinkStatus;

constexpr std::initializer_list<TapeOp> kReads = {TapeOp::ReadOk, TapeOp::ReadBusy, TapeOp::ReadDown};
constexpr std::initializer_list<TapeOp> kReceives = {TapeOp::CanReceive, TapeOp::ReadBusy, TapeOp::ReadDown};

LinkStatus status_of_read(TapeOp op) noexcept {
  switch (op) {
    case TapeOp::ReadOk:
    case TapeOp::CanReceive:
      return LinkStatus::Ok;
    case TapeOp::ReadDown:
      return LinkStatus::Down;
    default:
      return LinkStatus::Busy;
  }
}

firmware::TapeLinkState opened(const TapePlayer& player, HeadLink link) {
  return player.opened(link).value_or(firmware::TapeLinkState{});
}

template <typename Link>
std::unique_ptr<Link> make_link(TapePlayer& player, HeadLink link) {
  return player.opened(link) ? std::make_unique<Link>(player, link) : nullptr;
}

}  // namespace

PlaybackByteLink::PlaybackByteLink(TapePlayer& player, HeadLink link)
    : player_(player), link_(link), state_(opened(player, link)) {
}

void PlaybackByteLink::follow(TapeOp op) {
  if (const auto state = player_.state_change(link_, op)) {
    state_ = *state;
  }
}

void PlaybackByteLink::service(hal::Stamp) noexcept {
  follow(TapeOp::Service);
}

hal::ByteRead PlaybackByteLink::read(std::span<std::uint8_t> into) noexcept {
  const auto taped = player_.answer(link_, kReads);
  if (!taped) {
    return {};
  }
  if (taped->bytes.size() > into.size()) {
    player_.diverge("a read of at most " + std::to_string(into.size()) + " bytes");
    return {};
  }
  std::copy(taped->bytes.begin(), taped->bytes.end(), into.begin());
  const hal::ByteRead result{status_of_read(taped->op), taped->bytes.size(), taped->time};
  follow(TapeOp::After);
  return result;
}

LinkStatus PlaybackByteLink::write(std::span<const std::uint8_t> bytes) noexcept {
  const auto taped = player_.answer(link_, {TapeOp::Write});
  if (!taped) {
    return LinkStatus::Busy;
  }
  if (!std::equal(bytes.begin(), bytes.end(), taped->bytes.begin(), taped->bytes.end())) {
    TapeOperation done = *taped;
    done.bytes = bytes;
    player_.diverge(text_of(done));
    return LinkStatus::Busy;
  }
  follow(TapeOp::After);
  return taped->status;
}

LinkStatus PlaybackByteLink::set_baud(std::uint32_t baud) noexcept {
  const auto taped = player_.answer(link_, {TapeOp::SetBaud});
  if (!taped) {
    return LinkStatus::Down;
  }
  if (taped->baud != baud) {
    TapeOperation done = *taped;
    done.baud = baud;
    player_.diverge(text_of(done));
    return LinkStatus::Down;
  }
  follow(TapeOp::After);
  return taped->status;
}

void PlaybackByteLink::discard_input() noexcept {
  if (player_.answer(link_, {TapeOp::Discard})) {
    follow(TapeOp::After);
  }
}

PlaybackCanLink::PlaybackCanLink(TapePlayer& player, HeadLink link)
    : player_(player), link_(link), state_(opened(player, link)) {
}

void PlaybackCanLink::follow(TapeOp op) {
  if (const auto state = player_.state_change(link_, op)) {
    state_ = *state;
  }
}

void PlaybackCanLink::service(hal::Stamp) noexcept {
  follow(TapeOp::Service);
}

hal::CanRead PlaybackCanLink::receive() noexcept {
  const auto taped = player_.answer(link_, kReceives);
  if (!taped) {
    return {};
  }
  follow(TapeOp::After);
  return {status_of_read(taped->op), taped->frame, taped->time};
}

LinkStatus PlaybackCanLink::send(const hal::CanFrame& frame) noexcept {
  const auto taped = player_.answer(link_, {TapeOp::CanSend});
  if (!taped) {
    return LinkStatus::Busy;
  }
  const bool is_same = frame.id == taped->frame.id && frame.extended == taped->frame.extended &&
                       std::ranges::equal(frame.bytes(), taped->frame.bytes());
  if (!is_same) {
    TapeOperation done = *taped;
    done.frame = frame;
    player_.diverge(text_of(done));
    return LinkStatus::Busy;
  }
  follow(TapeOp::After);
  return taped->status;
}

firmware::OwnedHeadLinks playback_links(TapePlayer& player) {
  return {make_link<PlaybackByteLink>(player, HeadLink::PanTiltBytes),
          make_link<PlaybackCanLink>(player, HeadLink::PanTiltCan),
          make_link<PlaybackByteLink>(player, HeadLink::RangefinderBytes),
          make_link<PlaybackCanLink>(player, HeadLink::RangefinderCan)};
}

}  // namespace slamsensor::tools
