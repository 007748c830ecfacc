#pragma once

#include "firmware/device/head_drivers.hpp"
#include "tools/recording/tape_player.hpp"

#include <cstdint>
#include <memory>

namespace slamsensor::tools {

/// A byte link as a driver met it when a tape was recorded. When the tape is over nothing arrives any more.
class PlaybackByteLink final : public hal::ByteLink {
 public:
  /// `player` outlives it and has opened `link`.
  PlaybackByteLink(TapePlayer& player, firmware::HeadLink link);

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return state_.epoch; }
  [[nodiscard]] bool is_up() const noexcept override { return state_.is_up; }
  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override;
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override;
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] std::uint32_t baud() const noexcept override { return state_.baud; }
  void discard_input() noexcept override;

 private:
  void follow(firmware::TapeOp op);

  TapePlayer& player_;
  firmware::HeadLink link_;
  firmware::TapeLinkState state_;
};

/// The same for a CAN link.
class PlaybackCanLink final : public hal::CanLink {
 public:
  PlaybackCanLink(TapePlayer& player, firmware::HeadLink link);

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return state_.epoch; }
  [[nodiscard]] bool is_up() const noexcept override { return state_.is_up; }
  [[nodiscard]] hal::CanRead receive() noexcept override;
  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override;

 private:
  void follow(firmware::TapeOp op);

  TapePlayer& player_;
  firmware::HeadLink link_;
  firmware::TapeLinkState state_;
};

/// The links of the head whose tape it is.
[[nodiscard]] firmware::OwnedHeadLinks playback_links(TapePlayer& player);

}  // namespace slamsensor::tools
