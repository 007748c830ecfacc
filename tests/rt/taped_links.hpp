#pragma once

#include "hal/transport/byte_link.hpp"
#include "hal/transport/can_link.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::tests {

/// What a link gave to its driver, call by call. A driver that is stepped at the same times does the same
/// calls, so that it can be run again without the device: in its own thread, with nothing else in it.
struct LinkTape {
  struct State {  ///< after each service()
    bool up = false;
    std::uint32_t epoch = 0;
    std::uint32_t baud = 0;
  };
  struct Read {
    hal::LinkStatus status = hal::LinkStatus::Busy;
    std::size_t count = 0;
    hal::Stamp stamp{};
  };

  std::vector<State> states;
  std::vector<Read> reads;
  std::vector<std::uint8_t> bytes;
  std::vector<hal::CanRead> frames;
  std::vector<hal::LinkStatus> writes;
  std::vector<hal::LinkStatus> bauds;
};

/// Where a replay is on its tape.
struct TapePlace {
  std::size_t states = 0;
  std::size_t reads = 0;
  std::size_t bytes = 0;
  std::size_t frames = 0;
  std::size_t writes = 0;
  std::size_t bauds = 0;
};

/// A link to a device that writes down what it gives.
class RecordingByteLink final : public hal::ByteLink {
 public:
  RecordingByteLink(hal::ByteLink& link, LinkTape& tape) : link_(link), tape_(tape) {}

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return link_.epoch(); }
  [[nodiscard]] bool is_up() const noexcept override { return link_.is_up(); }
  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override;
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override;
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] std::uint32_t baud() const noexcept override { return link_.baud(); }
  void discard_input() noexcept override { link_.discard_input(); }

 private:
  hal::ByteLink& link_;
  LinkTape& tape_;
};

class RecordingCanLink final : public hal::CanLink {
 public:
  RecordingCanLink(hal::CanLink& link, LinkTape& tape) : link_(link), tape_(tape) {}

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return link_.epoch(); }
  [[nodiscard]] bool is_up() const noexcept override { return link_.is_up(); }
  [[nodiscard]] hal::CanRead receive() noexcept override;
  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override;

 private:
  hal::CanLink& link_;
  LinkTape& tape_;
};

/// Gives the same again, and asks for nothing. What goes beyond the tape is Down, and counted.
class ReplayedByteLink final : public hal::ByteLink {
 public:
  explicit ReplayedByteLink(const LinkTape& tape) : tape_(tape) {}

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return state_.epoch; }
  [[nodiscard]] bool is_up() const noexcept override { return state_.up; }
  [[nodiscard]] hal::ByteRead read(std::span<std::uint8_t> into) noexcept override;
  [[nodiscard]] hal::LinkStatus write(std::span<const std::uint8_t> bytes) noexcept override;
  hal::LinkStatus set_baud(std::uint32_t baud) noexcept override;
  [[nodiscard]] std::uint32_t baud() const noexcept override { return state_.baud; }
  void discard_input() noexcept override {}

  /// Calls that the recorded driver did not make.
  [[nodiscard]] std::size_t beyond() const noexcept { return beyond_; }

 private:
  const LinkTape& tape_;
  TapePlace place_;
  LinkTape::State state_;
  std::size_t beyond_ = 0;
};

class ReplayedCanLink final : public hal::CanLink {
 public:
  explicit ReplayedCanLink(const LinkTape& tape) : tape_(tape) {}

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return state_.epoch; }
  [[nodiscard]] bool is_up() const noexcept override { return state_.up; }
  [[nodiscard]] hal::CanRead receive() noexcept override;
  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override;

  [[nodiscard]] std::size_t beyond() const noexcept { return beyond_; }

 private:
  const LinkTape& tape_;
  TapePlace place_;
  LinkTape::State state_;
  std::size_t beyond_ = 0;
};

}  // namespace slamsensor::tests
